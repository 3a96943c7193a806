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
