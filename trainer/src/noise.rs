//! How much of a residual is noise that no model could remove.

use crate::campaign::Run;

/// The residuals of one run in the order of its rows, g.
pub type RunResiduals = Vec<f64>;

/// References closer than this belong to the same state, g.
const SAME_STATE_G: f64 = 1e-3;
/// Median of |x − y| / √2 of two independent normal values, as a fraction of their σ.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// Standard deviation of the noise from one sample to the next, g.
///
/// From differences of neighbours within a state, so that whatever a model misses cancels as long as
/// it is slower than the sampling. The median instead of the mean square, so that the steps at the
/// beginning of a state don't count. `None` where no two neighbours share a state.
#[must_use]
pub fn sample_sigma_g<'a>(runs: impl IntoIterator<Item = (&'a Run, &'a RunResiduals)>) -> Option<f64> {
    let mut steps: Vec<f64> = Vec::new();
    for (run, residuals) in runs {
        for (rows, pair) in run.rows.windows(2).zip(residuals.windows(2)) {
            if (rows[1].reference_g - rows[0].reference_g).abs() < SAME_STATE_G {
                steps.push((pair[1] - pair[0]).abs());
            }
        }
    }
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median / MEDIAN_OF_NORMAL / 2.0_f64.sqrt())
}

/// Where the scatter of a residual comes from, as standard deviations.
///
/// A calibration's residuals are not white: flicker makes a whole state lie off, turn-on and mounting
/// a whole run. A fit that takes every sample for an independent witness believes them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Components {
    /// From sample to sample, g.
    pub sample_g: f64,
    /// From state to state beyond what averaging samples leaves, g.
    pub state_g: f64,
    /// From run to run beyond what averaging states leaves, g.
    pub run_g: f64,
}

/// A mean of samples: its run, how many they are, and its residual.
#[derive(Clone, Copy, Debug)]
pub struct Mean {
    /// The run.
    pub run: usize,
    /// Samples.
    pub samples: f64,
    /// Residual of the mean, g.
    pub residual_g: f64,
}

impl Components {
    /// Method of moments from the residuals of means, given the sample-to-sample noise.
    #[must_use]
    pub fn estimate(sample_g: f64, means: &[Mean]) -> Self {
        let variance_of = |mean: &Mean| sample_g * sample_g / mean.samples;
        let (mut within, mut states) = (0.0, 0.0);
        let (mut between, mut runs) = (0.0, 0.0);
        for run in means.chunk_by(|a, b| a.run == b.run) {
            let count = run.len() as f64;
            let centre = run.iter().map(|mean| mean.residual_g).sum::<f64>() / count;
            let scatter: f64 = run.iter().map(|mean| (mean.residual_g - centre).powi(2)).sum();
            let noise: f64 = run.iter().map(variance_of).sum();
            within += scatter - noise * (1.0 - count.recip());
            states += count - 1.0;
            between += centre * centre - (scatter / (count - 1.0).max(1.0)) / count;
            runs += 1.0;
        }
        let root = |sum: f64, count: f64| if count > 0.0 { (sum / count).max(0.0).sqrt() } else { 0.0 };
        Self { sample_g, state_g: root(within, states), run_g: root(between, runs) }
    }

    /// Weight of a mean of so many samples, where a single sample without state scatter weighs one.
    #[must_use]
    pub fn weight(&self, samples: f64) -> f64 {
        samples / (1.0 + samples * (self.state_g / self.sample_g).powi(2))
    }

    /// Variance of a run's offset in units of the variance of one sample.
    #[must_use]
    pub fn run_variance(&self) -> f64 {
        (self.run_g / self.sample_g).powi(2)
    }
}

/// Root mean square.
#[must_use]
pub fn rms<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0_u64), |(sum, count), value| (sum + value * value, count + 1));
    if count == 0 { 0.0 } else { (sum / count as f64).sqrt() }
}
