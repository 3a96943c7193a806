//! How much of a residual is noise that no model could remove.

use crate::campaign::{Row, Run};

/// The residuals of one run in the order of its rows, g.
pub type RunResiduals = Vec<f64>;

/// References closer than this share of half of what all span belong to the same state,
const SAME_STATE: f64 = 1e-3;
/// and so do any that differ by less than so many steps of the residual: what scatters less than the reading does is no
/// move.
const SAME_STEPS: f64 = 4.0;
/// A smaller share of neighbours meets at one reference by chance. Their inputs differ, and so does what
/// the model misses of them. And a smaller share is written again by chance: counters count in steps.
const LEAST_SHARE: f64 = 0.1;
/// Median of the magnitude of a normal value of mean zero, as a fraction of its σ.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// Standard deviation of the noise from one sample to the next, g.
///
/// From differences of neighbours within a state, so that whatever a model misses cancels as long as
/// it is slower than the sampling. The median instead of the mean square, so that the steps at the
/// beginning of a state don't count; nor do rows that were written again before there was anything new to read.
/// `None` where neighbours share a state by chance at most.
#[must_use]
pub fn sample_sigma_g<'a>(runs: impl IntoIterator<Item = (&'a Run, &'a RunResiduals)>) -> Option<f64> {
    let (mut both, mut again): (Vec<[f64; 2]>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (run, residuals) in runs {
        let step = |(rows, pair): (&[Row], &[f64])| {
            [rows[1].reference_g - rows[0].reference_g, pair[1] - pair[0]].map(f64::abs)
        };
        for (rows, pair) in run.rows.windows(2).zip(residuals.windows(2)) {
            let side = if is_written_again(rows) { &mut again } else { &mut both };
            side.push(step((rows, pair)));
        }
        (low, high) =
            run.rows.iter().fold((low, high), |(low, high), row| (low.min(row.reference_g), high.max(row.reference_g)));
    }
    if (again.len() as f64) < LEAST_SHARE * (again.len() + both.len()) as f64 {
        both.append(&mut again);
    }
    let typical = normal_sigma(both.iter().map(|[_, step]| *step).collect());
    let same = (SAME_STATE * (high / 2.0 - low / 2.0)).max(SAME_STEPS * typical);
    let steps: Vec<f64> = both.iter().filter(|[apart, _]| *apart <= same).map(|[_, step]| *step).collect();
    if (steps.len() as f64) < LEAST_SHARE * both.len() as f64 || steps.is_empty() {
        return None;
    }
    Some(normal_sigma(steps) / 2.0_f64.sqrt())
}

/// Whether signal and thermometer are the same to the last digit: a logger was faster than the sensor.
fn is_written_again(rows: &[Row]) -> bool {
    let [before, here] = [&rows[0].sample, &rows[1].sample];
    (before.delta_f_uhz, before.temperature_uc) == (here.delta_f_uhz, here.temperature_uc)
}

/// Standard deviation of normal values by the median of their magnitudes; 0 for none.
pub(crate) fn normal_sigma(mut magnitudes: Vec<f64>) -> f64 {
    let middle = magnitudes.len() / 2;
    if magnitudes.is_empty() {
        return 0.0;
    }
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    *median / MEDIAN_OF_NORMAL
}

/// Where the scatter of a residual comes from, as standard deviations.
///
/// A calibration's residuals are not white: flicker and table errors make a whole state lie off,
/// turn-on and mounting a whole run. A fit that takes every sample for an independent witness believes
/// them. States scatter differently from run to run: a recording at rest has no table errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    /// From sample to sample, g.
    pub sample_g: f64,
    /// From state to state beyond what averaging samples leaves, g; run by run.
    pub state_g: Vec<f64>,
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
    /// Method of moments from the residuals of means, grouped by run, given the sample-to-sample noise.
    #[must_use]
    pub fn estimate(sample_g: f64, means: &[Mean]) -> Self {
        let runs: Vec<RunScatter> =
            means.chunk_by(|a, b| a.run == b.run).map(|run| RunScatter::of(sample_g, run)).collect();
        let count = runs.len() as f64;
        let between = runs.iter().map(|run| run.centre_g.powi(2) - run.centre_variance).sum::<f64>() / count.max(1.0);
        Self {
            sample_g,
            state_g: runs.iter().map(|run| run.state_variance.sqrt()).collect(),
            run_g: between.max(0.0).sqrt(),
        }
    }

    /// Weight of a mean of so many samples of training run number `run`, where a single sample without
    /// state scatter weighs one.
    #[must_use]
    pub fn weight(&self, run: usize, samples: f64) -> f64 {
        let state_g = self.state_g.get(run).copied().unwrap_or_default();
        samples / (1.0 + samples * (state_g / self.sample_g).powi(2))
    }

    /// Variance of a run's offset in units of the variance of one sample.
    #[must_use]
    pub fn run_variance(&self) -> f64 {
        (self.run_g / self.sample_g).powi(2)
    }
}

struct RunScatter {
    centre_g: f64,
    centre_variance: f64,
    state_variance: f64,
}

impl RunScatter {
    fn of(sample_g: f64, means: &[Mean]) -> Self {
        let count = means.len() as f64;
        let centre_g = means.iter().map(|mean| mean.residual_g).sum::<f64>() / count;
        let scatter: f64 = means.iter().map(|mean| (mean.residual_g - centre_g).powi(2)).sum();
        let noise: f64 = means.iter().map(|mean| sample_g * sample_g / mean.samples).sum();
        let freedom = (count - 1.0).max(1.0);
        Self {
            centre_g,
            centre_variance: scatter / freedom / count,
            state_variance: ((scatter - noise * (1.0 - count.recip())) / freedom).max(0.0),
        }
    }
}

/// Root mean square.
#[must_use]
pub fn rms<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0_u64), |(sum, count), value| (sum + value * value, count + 1));
    if count == 0 { 0.0 } else { (sum / count as f64).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Sample;
    use std::path::PathBuf;

    #[test]
    fn samples_that_meet_by_chance_tell_no_noise() {
        let run = |levels: u64| Run {
            name: "run".to_owned(),
            kind: String::new(),
            source: PathBuf::new(),
            rows: (0..100).map(|k| row(k, (k * levels / 100) as f64)).collect(),
        };
        let residuals: RunResiduals = (0..100).map(|k| f64::from(k % 2) * 1e-3).collect();
        assert_eq!(sample_sigma_g([(&run(98), &residuals)]), None);
        assert!(sample_sigma_g([(&run(10), &residuals)]).is_some());
    }

    fn row(second: u64, reference_g: f64) -> Row {
        let sample = Sample::from_difference(second * 1_000_000, second as i64, 0);
        Row { sample, reference_g, reference_sigma_g: None }
    }

    #[test]
    fn rows_that_were_written_again_tell_no_noise() {
        let once: Vec<f64> = (0..200).map(|k| f64::from(k * 37 % 101) * 1e-6).collect();
        let run = |times: u64| Run {
            name: "run".to_owned(),
            kind: String::new(),
            source: PathBuf::new(),
            rows: (0..200 * times).map(|k| row(k / times, 1.0)).collect(),
        };
        let thrice: RunResiduals = once.iter().flat_map(|value| [*value; 3]).collect();
        let sigma = |run: &Run, residuals| sample_sigma_g([(run, residuals)]).expect("neighbours share a state");
        let (plain, again) = (sigma(&run(1), &once), sigma(&run(3), &thrice));
        assert!(plain > 1e-6 && (again - plain).abs() < 1e-12, "{plain} {again}");
    }

    #[test]
    fn scatter_is_told_apart_by_where_it_comes_from() {
        // Two runs of states ±3 and ±1 about offsets of +10 and −10; sample noise is negligible.
        let states = |run: usize, offset: f64, size: f64| {
            (0..100).map(move |k| Mean {
                run,
                samples: 30.0,
                residual_g: offset + if k % 2 == 0 { size } else { -size },
            })
        };
        let means: Vec<Mean> = states(0, 10.0, 3.0).chain(states(1, -10.0, 1.0)).collect();
        let components = Components::estimate(1e-3, &means);
        assert!((components.state_g[0] - 3.0).abs() < 0.05 && (components.state_g[1] - 1.0).abs() < 0.05);
        assert!((components.run_g - 10.0).abs() < 0.05, "{components:?}");
        assert!(components.weight(1, 30.0) > 8.0 * components.weight(0, 30.0));
    }

    #[test]
    fn white_noise_has_neither_state_nor_run_scatter() {
        // A deterministic sequence with the moments of white noise averaged over 25 samples.
        let value = |k: usize| 0.2 * (2.0_f64).sqrt() * (k as f64 * 2.399_963).sin();
        let means: Vec<Mean> = (0..400).map(|k| Mean { run: k / 200, samples: 25.0, residual_g: value(k) }).collect();
        let components = Components::estimate(1.0, &means);
        assert!(components.state_g.iter().all(|state_g| *state_g < 0.05), "{components:?}");
        assert!(components.run_g < 0.05, "{components:?}");
    }
}
