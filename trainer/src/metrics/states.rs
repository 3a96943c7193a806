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

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Sample;
    use std::path::PathBuf;

    /// A run of these references and temperatures, °C, a second apart.
    fn run(rows: impl IntoIterator<Item = (f64, f64)>) -> Run {
        let row = |(second, (reference_g, c)): (u64, (f64, f64))| Row {
            sample: Sample::from_difference(second * 1_000_000, 0, (c * 1e6) as i32),
            reference_g,
            reference_sigma_g: None,
        };
        let rows = (0..).zip(rows).map(row).collect();
        Run { name: "run".into(), kind: "zero".into(), source: PathBuf::new(), rows }
    }

    #[test]
    fn at_one_level_a_step_of_a_degree_ends_a_state() {
        let found = states(&run([0.0, 0.0, 0.9, 0.9, 1.9, 1.9].map(|c| (0.5, c))));
        assert_eq!(found.iter().map(|state| state.rows.clone()).collect::<Vec<_>>(), [0..4, 4..6]);
        assert!((found[0].temperature_c - 0.45).abs() < 1e-9 && (found[1].temperature_c - 1.9).abs() < 1e-9);
        assert!(found.iter().all(|state| (state.reference_g - 0.5).abs() < 1e-12));
    }

    #[test]
    fn what_creeps_by_a_degree_is_no_state() {
        assert_eq!(states(&run([0.0, 0.5, 1.0].map(|c| (0.5, c)))), []);
        assert_eq!(states(&run([0.0, 0.5, 0.999].map(|c| (0.5, c)))).len(), 1);
    }

    #[test]
    fn a_level_ends_where_the_reference_is_further_off_than_its_scatter() {
        // A span of 1 g: levels are 5 mg wide.
        let found = states(&run([0.0, 0.0, 0.0, 0.005, 1.0, 1.0, 1.0, 0.994].map(|reference_g| (reference_g, 25.0))));
        assert_eq!(found.iter().map(|state| state.rows.clone()).collect::<Vec<_>>(), [0..4, 4..7, 7..8]);
    }
}
