//! Allan deviation.

use crate::campaign::Run;
use serde::Serialize;

/// What the figures mean.
pub const DEFINITION: &str = "overlapping Allan deviation of the residual at averaging times of 1, 2, 4, … samples up \
    to a quarter of the recording (IEEE Std 952); its relative uncertainty is about 1/√(2·(n/m − 1)) for m of n samples.";

/// One point of an Allan plot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AllanPoint {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Deviation, µg.
    pub deviation_ug: f64,
    /// Its relative standard uncertainty for white noise.
    pub relative_uncertainty: f64,
}

/// A step that differs from the median by more than this fraction is a gap.
const EVEN: f64 = 0.01;
/// Fewer samples than this make no plot.
const LEAST_SAMPLES: usize = 64;

/// The Allan deviation of `outputs_g`, one of each row; `None` of a short run or one with gaps.
#[must_use]
pub fn allan(run: &Run, outputs_g: &[f64]) -> Option<Vec<AllanPoint>> {
    let interval_s = run.sample_interval_s()?;
    let even = |pair: &[crate::campaign::Row]| {
        let step_s = pair[1].sample.time_us.saturating_sub(pair[0].sample.time_us) as f64 * 1e-6;
        (step_s - interval_s).abs() <= EVEN * interval_s
    };
    if outputs_g.len() < LEAST_SAMPLES || !run.rows.windows(2).all(even) {
        return None;
    }
    // The integral of the output: second differences of it are differences of neighbouring means.
    let mut integral = vec![0.0];
    let mut sum = 0.0;
    integral.extend(outputs_g.iter().map(|output| {
        sum += output;
        sum
    }));
    let averages = std::iter::successors(Some(1_usize), |m| Some(m * 2)).take_while(|m| *m <= outputs_g.len() / 4);
    Some(averages.map(|m| point(&integral, m, interval_s)).collect())
}

fn point(integral: &[f64], m: usize, interval_s: f64) -> AllanPoint {
    let samples = integral.len() - 1;
    let terms = samples - 2 * m + 1;
    let squares: f64 = (0..terms).map(|i| (integral[i + 2 * m] - 2.0 * integral[i + m] + integral[i]).powi(2)).sum();
    let width = m as f64;
    AllanPoint {
        tau_s: width * interval_s,
        deviation_ug: (squares / (2.0 * width * width * terms as f64)).sqrt() * 1e6,
        relative_uncertainty: (2.0 * (samples as f64 / width - 1.0)).sqrt().recip(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Row;
    use protocol::Sample;
    use std::path::PathBuf;

    /// A recording at rest with rows at these times, s.
    fn run(times_s: impl IntoIterator<Item = f64>) -> Run {
        let row = |time_s: f64| Row {
            sample: Sample::from_difference((time_s * 1e6).round() as u64, 0, 0),
            reference_g: 0.0,
            reference_sigma_g: None,
        };
        let rows = times_s.into_iter().map(row).collect();
        Run { name: "zero".into(), kind: "zero".into(), source: PathBuf::new(), rows }
    }

    fn near(found: f64, expected: f64) -> bool {
        (found - expected).abs() < 1e-9 * expected.abs().max(1.0)
    }

    #[test]
    fn an_alternation_deviates_by_root_two_at_one_sample_and_by_nothing_at_two() {
        let outputs_g: Vec<f64> = (0..64).map(|k| if k % 2 == 0 { 1e-6 } else { -1e-6 }).collect();
        let points = allan(&run((0..64).map(|k| f64::from(k) * 0.5)), &outputs_g).expect("64 samples");
        assert_eq!(points.iter().map(|point| point.tau_s).collect::<Vec<_>>(), [0.5, 1.0, 2.0, 4.0, 8.0]);
        assert!(near(points[0].deviation_ug, std::f64::consts::SQRT_2), "{points:?}");
        assert!(points[1..].iter().all(|point| point.deviation_ug < 1e-9), "{points:?}");
    }

    #[test]
    fn a_drift_deviates_by_its_change_over_the_averaging_time_over_root_two() {
        let outputs_g: Vec<f64> = (0..100).map(|k| f64::from(k) * 3e-6).collect();
        let points = allan(&run((0..100).map(|k| f64::from(k) * 2.0)), &outputs_g).expect("100 samples");
        assert_eq!(points.len(), 5, "1 to 16 of 100 samples");
        for (point, m) in points.iter().zip([1.0, 2.0, 4.0, 8.0, 16.0]) {
            assert!(near(point.tau_s, 2.0 * m) && near(point.deviation_ug, 3.0 * m / 2.0_f64.sqrt()), "{point:?}");
            assert!(near(point.relative_uncertainty, 1.0 / (2.0 * (100.0 / m - 1.0)).sqrt()), "{point:?}");
        }
    }

    #[test]
    fn the_last_sample_counts_as_all_others_do() {
        let mut outputs_g = vec![0.0; 64];
        outputs_g[63] = 1e-6;
        let points = allan(&run((0..64).map(f64::from)), &outputs_g).expect("64 samples");
        // One of 63 differences is 1 µg; at two samples, of 61 differences of means the last is half a µg.
        assert!(near(points[0].deviation_ug, (1.0_f64 / 126.0).sqrt()), "{points:?}");
        assert!(near(points[1].deviation_ug, (0.25_f64 / 122.0).sqrt()), "{points:?}");
    }

    #[test]
    fn a_short_or_uneven_recording_has_no_plot() {
        let plot = |times_s: Vec<f64>| allan(&run(times_s.clone()), &vec![0.0; times_s.len()]);
        let even = |count: u32| (0..count).map(|k| f64::from(k) * 100.0).collect::<Vec<f64>>();
        assert!(plot(even(63)).is_none() && plot(even(64)).is_some());
        let stretched =
            |by_s: f64| even(64).into_iter().map(move |time_s| if time_s > 3000.0 { time_s + by_s } else { time_s });
        assert!(plot(stretched(1.0).collect()).is_some(), "a hundredth is no gap");
        assert!(plot(stretched(1.1).collect()).is_none() && plot(stretched(-1.1).collect()).is_none());
        assert!(plot(stretched(3000.0).collect()).is_none());
    }
}
