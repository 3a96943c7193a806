//! Stretches of a run in which neither level nor temperature changes.

use super::levels::level_width;
use crate::campaign::{Row, Run};
use std::ops::Range;

/// One such stretch: what a turntable position at a soaked node records.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Its rows within the run.
    pub rows: Range<usize>,
    /// Mean applied acceleration, g.
    pub reference_g: f64,
    /// Mean temperature, °C.
    pub temperature_c: f64,
}

/// A state whose temperature wanders further than this is no state, °C.
const SAME_TEMPERATURE_C: f64 = 1.0;

/// The states of a run in order. A ramp has none.
#[must_use]
pub fn states(run: &Run) -> Vec<State> {
    let references: Vec<f64> = run.rows.iter().map(|row| row.reference_g).collect();
    let width = level_width(&references);
    let mut start = 0;
    let mut found = Vec::new();
    while let Some(first) = run.rows.get(start) {
        let same =
            |pair: &&[Row]| (pair[1].reference_g - first.reference_g).abs() <= width && adjoin(&pair[0], &pair[1]);
        let end = start + 1 + run.rows[start..].windows(2).take_while(same).count();
        found.extend(state(&run.rows[start..end], start));
        start = end;
    }
    found
}

/// A node change between two states at the same level shows as a step in temperature.
fn adjoin(a: &Row, b: &Row) -> bool {
    a.sample.temperature_uc.abs_diff(b.sample.temperature_uc) < (SAME_TEMPERATURE_C * 1e6) as u32
}

fn state(rows: &[Row], start: usize) -> Option<State> {
    let temperatures = || rows.iter().map(|row| f64::from(row.sample.temperature_uc) * 1e-6);
    let span = temperatures().fold(f64::MIN, f64::max) - temperatures().fold(f64::MAX, f64::min);
    let count = rows.len() as f64;
    (span < SAME_TEMPERATURE_C).then(|| State {
        rows: start..start + rows.len(),
        reference_g: rows.iter().map(|row| row.reference_g).sum::<f64>() / count,
        temperature_c: temperatures().sum::<f64>() / count,
    })
}
