//! Stretches of a run in which neither level nor temperature changes.

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

/// References further apart than this are different levels, g.
const SAME_LEVEL_G: f64 = 0.01;
/// A state whose temperature wanders further than this is no state, °C.
const SAME_TEMPERATURE_C: f64 = 1.0;

/// The states of a run in order. A ramp has none.
#[must_use]
pub fn states(run: &Run) -> Vec<State> {
    let same_level = |a: &Row, b: &Row| (a.reference_g - b.reference_g).abs() < SAME_LEVEL_G && adjoin(a, b);
    let mut start = 0;
    let mut found = Vec::new();
    for rows in run.rows.chunk_by(same_level) {
        found.extend(state(rows, start));
        start += rows.len();
    }
    found
}

/// A node change between two states at the same level shows as a step in temperature.
fn adjoin(a: &Row, b: &Row) -> bool {
    (a.sample.temperature_uc - b.sample.temperature_uc).abs() < (SAME_TEMPERATURE_C * 1e6) as i32
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
