//! Zero-bias stability (Huang et al. 2022, Table 1).

use super::standard_deviation;
use crate::campaign::Run;
use serde::Serialize;

/// What the figures mean.
pub const DEFINITION: &str = "zero-bias stability = standard deviation (n − 1) of the samples at their own rate over \
    a recording at 0 g, from power-on, after 20 and after 30 minutes (Huang et al. 2022, Table 1). It is blind to a \
    constant error, and it is not the bias instability of an Allan plot.";

/// Zero-bias stability of one run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ZeroBias {
    /// From the first sample, µg.
    pub from_start_ug: f64,
    /// From 20 minutes after power-on, µg.
    pub after_20_min_ug: f64,
    /// From 30 minutes after power-on, µg.
    pub after_30_min_ug: f64,
}

/// A recording must go on for this long after the last starting point, s.
const LEAST_TAIL_S: f64 = 600.0;

/// The figures of `outputs_g`, one of each row; `None` unless the run is of kind `zero` and long enough.
#[must_use]
pub fn zero_bias(run: &Run, outputs_g: &[f64]) -> Option<ZeroBias> {
    let power_on_s = |index: usize| run.rows.get(index).map(|row| row.sample.power_on_us as f64 * 1e-6);
    let last_s = power_on_s(run.rows.len().checked_sub(1)?)?;
    if run.kind != "zero" || last_s < 1800.0 + LEAST_TAIL_S {
        return None;
    }
    let after_ug = |start_s: f64| {
        let kept: Vec<f64> = outputs_g
            .iter()
            .enumerate()
            .filter(|(index, _)| power_on_s(*index).is_some_and(|time| time >= start_s))
            .map(|(_, output)| *output)
            .collect();
        standard_deviation(&kept) * 1e6
    };
    Some(ZeroBias {
        from_start_ug: after_ug(0.0),
        after_20_min_ug: after_ug(1200.0),
        after_30_min_ug: after_ug(1800.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Row;
    use protocol::Sample;
    use std::path::PathBuf;

    /// Rows every ten seconds, the first so long after power-on.
    fn run(kind: &str, first_s: u64, count: u64) -> Run {
        let row = |index: u64| Row {
            sample: Sample {
                power_on_us: (first_s + 10 * index) * 1_000_000,
                ..Sample::from_difference(index * 10_000_000, 0, 0)
            },
            reference_g: 0.0,
            reference_sigma_g: None,
        };
        Run { name: "zero".into(), kind: kind.into(), source: PathBuf::new(), rows: (0..count).map(row).collect() }
    }

    #[test]
    fn each_figure_begins_at_its_own_moment_and_knows_no_constant() {
        // ±9 µg for twenty minutes, ±4 µg for ten, ±1 µg for ten more.
        let size_ug = |second: u64| {
            if second < 1200 {
                9.0
            } else if second < 1800 {
                4.0
            } else {
                1.0
            }
        };
        let sign = |k: u64| if k.is_multiple_of(2) { 1e-6 } else { -1e-6 };
        let outputs_g: Vec<f64> = (0..241).map(|k| 1e-3 + sign(k) * size_ug(10 * k)).collect();
        let found = zero_bias(&run("zero", 0, 241), &outputs_g).expect("forty minutes");
        let expected = |parts: &[(f64, f64)]| {
            let count: f64 = parts.iter().map(|(count, _)| count).sum();
            (parts.iter().map(|(count, size)| count * size * size).sum::<f64>() / (count - 1.0)).sqrt()
        };
        let near = |found_ug: f64, expected_ug: f64| (found_ug / expected_ug - 1.0).abs() < 1e-3;
        assert!(near(found.from_start_ug, expected(&[(120.0, 9.0), (60.0, 4.0), (61.0, 1.0)])), "{found:?}");
        assert!(near(found.after_20_min_ug, expected(&[(60.0, 4.0), (61.0, 1.0)])), "{found:?}");
        assert!(near(found.after_30_min_ug, expected(&[(61.0, 1.0)])), "{found:?}");
    }

    #[test]
    fn a_recording_at_zero_that_goes_on_for_ten_minutes_has_figures() {
        let has = |kind: &str, first_s: u64, count: u64| {
            zero_bias(&run(kind, first_s, count), &vec![0.0; count as usize]).is_some()
        };
        assert!(has("zero", 0, 241) && !has("zero", 0, 240) && !has("static", 0, 241) && !has("zero", 0, 0));
        assert!(has("zero", 2390, 2) && !has("zero", 2380, 2), "time counts from power-on");
    }
}
