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
/// Of the signal alone a larger share is the same again by chance: noise of less than a step of a counter stands still
/// more often than not only where nothing new was read.
const MOST_SAME_SIGNAL: f64 = 0.5;
/// Median of the magnitude of a normal value of mean zero, as a fraction of its σ.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// Standard deviation of the noise from one sample to the next, g.
///
/// From pseudo-residuals (Gasser, Sroka & Jennen-Steinmetz, Biometrika 1986, 73, 625): what a sample departs from the
/// straight line through its neighbours within a state, so that whatever a model misses cancels as long as it is straight
/// over three samples; from differences of neighbours where hardly any three share a state. The median instead of the mean
/// square, so that the steps at the beginning of a state don't count; nor do rows that were written again before there was
/// anything new to read. `None` where neighbours share a state by chance at most.
#[must_use]
pub fn sample_sigma_g<'a>(runs: impl IntoIterator<Item = (&'a Run, &'a RunResiduals)>) -> Option<f64> {
    let points = points(runs);
    let same_g = same_state_g(&points);
    sigma_within(&points, |neighbours| neighbours.windows(2).all(|pair| pair[0].apart_g(&pair[1]) <= same_g))
}

/// The same of what is left in any unit, whatever the reference does: it may never stand still, and what a map leaves makes
/// no step where it does. `None` where there are no three samples in a row.
#[must_use]
pub fn sample_sigma<'a>(runs: impl IntoIterator<Item = (&'a Run, &'a RunResiduals)>) -> Option<f64> {
    sigma_within(&points(runs), |_| true)
}

/// What was read anew, run by run.
fn points<'a>(runs: impl IntoIterator<Item = (&'a Run, &'a RunResiduals)>) -> Vec<Vec<Point>> {
    let runs: Vec<(&Run, &RunResiduals)> = runs.into_iter().collect();
    let rows: Vec<&[Row]> = runs.iter().map(|(run, _)| run.rows.as_slice()).collect();
    let once = written_once(&rows);
    let of_run = |((run, residuals), rows): (&(&Run, &RunResiduals), Vec<usize>)| {
        rows.into_iter().map(|row| Point::new(&run.rows[row], residuals[row])).collect()
    };
    runs.iter().zip(once).map(of_run).collect()
}

/// Standard deviation from neighbours in one state.
fn sigma_within(points: &[Vec<Point>], is_one_state: impl Fn(&[Point]) -> bool) -> Option<f64> {
    let is_one_state = |neighbours: &&[Point]| is_one_state(neighbours);
    let pairs = || points.iter().flat_map(|run| run.windows(2));
    let count = pairs().count() as f64;
    let steps: Vec<f64> = pairs().filter(is_one_state).map(|pair| pair[0].step_g(&pair[1]).abs()).collect();
    if (steps.len() as f64) < LEAST_SHARE * count || steps.is_empty() {
        return None;
    }
    let threes = points.iter().flat_map(|run| run.windows(3)).filter(is_one_state);
    let pseudo_residuals: Vec<f64> = threes.map(pseudo_residual_g).map(f64::abs).collect();
    if (pseudo_residuals.len() as f64) < LEAST_SHARE * count {
        return Some(normal_sigma(steps) / 2.0_f64.sqrt());
    }
    Some(normal_sigma(pseudo_residuals))
}

/// One residual, and where it stands.
struct Point {
    time_us: u64,
    reference_g: f64,
    residual_g: f64,
}

impl Point {
    fn new(row: &Row, residual_g: f64) -> Self {
        Self { time_us: row.sample.time_us, reference_g: row.reference_g, residual_g }
    }

    fn apart_g(&self, next: &Self) -> f64 {
        (next.reference_g - self.reference_g).abs()
    }

    fn step_g(&self, next: &Self) -> f64 {
        next.residual_g - self.residual_g
    }
}

/// How far references of one state may lie apart, g.
fn same_state_g(points: &[Vec<Point>]) -> f64 {
    let references = || points.iter().flatten().map(|point| point.reference_g);
    let half_span_g =
        references().fold(f64::NEG_INFINITY, f64::max) / 2.0 - references().fold(f64::INFINITY, f64::min) / 2.0;
    let steps = points.iter().flat_map(|run| run.windows(2)).map(|pair| pair[0].step_g(&pair[1]).abs());
    (SAME_STATE * half_span_g).max(SAME_STEPS * normal_sigma(steps.collect()))
}

/// What the middle of three departs from the straight line through the others, with the variance of one of them.
fn pseudo_residual_g(three: &[Point]) -> f64 {
    let [before, here, after] = [0, 1, 2].map(|index| &three[index]);
    let span_us = after.time_us.saturating_sub(before.time_us);
    let after_share =
        if span_us == 0 { 0.5 } else { here.time_us.saturating_sub(before.time_us) as f64 / span_us as f64 };
    let before_share = 1.0 - after_share;
    let departure_g = before_share * before.residual_g + after_share * after.residual_g - here.residual_g;
    departure_g / (1.0 + before_share.powi(2) + after_share.powi(2)).sqrt()
}

/// Of each run the rows at which something new was read, in order: a logger may be faster than the sensor.
fn written_once(runs: &[&[Row]]) -> Vec<Vec<usize>> {
    let (mut pairs, mut same_signal, mut same) = (0.0, 0.0, 0.0);
    for pair in runs.iter().flat_map(|rows| rows.windows(2)) {
        pairs += 1.0;
        same_signal += f64::from(u8::from(is_same_signal(pair)));
        same += f64::from(u8::from(is_same_signal(pair) && is_same_temperature(pair)));
    }
    let is_again = |pair: &[Row]| {
        is_same_signal(pair)
            && (same_signal > MOST_SAME_SIGNAL * pairs || same >= LEAST_SHARE * pairs && is_same_temperature(pair))
    };
    let once = |rows: &[Row]| (0..rows.len()).filter(|&row| row == 0 || !is_again(&rows[row - 1..=row])).collect();
    runs.iter().map(|rows| once(rows)).collect()
}

/// Whether the signal is the same to the last digit.
fn is_same_signal(pair: &[Row]) -> bool {
    pair[0].sample.delta_f_uhz == pair[1].sample.delta_f_uhz
}

fn is_same_temperature(pair: &[Row]) -> bool {
    pair[0].sample.temperature_uc == pair[1].sample.temperature_uc
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

    #[test]
    fn a_slope_is_no_noise_and_neither_is_one_at_uneven_times() {
        let noise = |k: u64| (k * 37 % 101) as f64 * 1e-7;
        let even = |k: u64| k;
        let uneven = |k: u64| k + k / 7 * 5;
        for second in [&even as &dyn Fn(u64) -> u64, &uneven] {
            let run = Run {
                name: "ramp".to_owned(),
                kind: String::new(),
                source: PathBuf::new(),
                rows: (0..400).map(|k| row(second(k), 1.0)).collect(),
            };
            let sigma = |slope: f64| {
                let residuals: RunResiduals = (0..400).map(|k| noise(k) + slope * second(k) as f64).collect();
                sample_sigma_g([(&run, &residuals)]).expect("neighbours share a state")
            };
            let (still, ramp) = (sigma(0.0), sigma(1e-4));
            assert!(still > 1e-6 && (ramp / still - 1.0).abs() < 1e-6, "{still} {ramp}");
        }
    }

    #[test]
    fn a_meter_that_is_slower_than_the_thermometer_is_read_once() {
        // Every fourth row is new; the thermometer, and the residual with it, is new in each.
        let noise = |k: u64| (k * 37 % 101) as f64 * 1e-7;
        let rows: Vec<Row> = (0..400)
            .map(|k| {
                let sample = Sample::from_difference(k * 1_000_000, (k / 4 * 37 % 101) as i64, (k % 7) as i32);
                Row { sample, reference_g: 1.0, reference_sigma_g: None }
            })
            .collect();
        let once = written_once(&[&rows]);
        assert_eq!(once[0], (0..100).map(|k| 4 * k).collect::<Vec<_>>());
        let run = Run { name: "slow".to_owned(), kind: String::new(), source: PathBuf::new(), rows };
        let residuals: RunResiduals = (0..400).map(|k| noise(k / 4) + 1e-10 * (k % 7) as f64).collect();
        let sigma = sample_sigma_g([(&run, &residuals)]).unwrap();
        assert!(sigma > 1e-6, "{sigma}");
        // A counter that stands still by chance, now and then, is read each time.
        let steps: Vec<Row> = (0..400).map(|k| row(k, (k * 37 % 101 / 40) as f64)).collect();
        let mut counter = steps;
        counter.iter_mut().for_each(|row| row.sample.delta_f_uhz = row.reference_g as i64);
        counter.iter_mut().enumerate().for_each(|(k, row)| row.sample.temperature_uc = k as i32);
        assert_eq!(written_once(&[&counter])[0].len(), 400);
    }

    fn row(second: u64, reference_g: f64) -> Row {
        let sample = Sample::from_difference(second * 1_000_000, second as i64, 0);
        Row { sample, reference_g, reference_sigma_g: None }
    }

    #[test]
    fn a_residual_tells_its_noise_in_any_unit_while_the_reference_sweeps() {
        let run = Run {
            name: "sweep".to_owned(),
            kind: String::new(),
            source: PathBuf::new(),
            rows: (0..400).map(|k| row(k, (k as f64 / 40.0).sin())).collect(),
        };
        let residuals = |unit: f64| -> RunResiduals { (0..400).map(|k| f64::from(k * 37 % 101) * unit).collect() };
        let sigma = |unit| sample_sigma([(&run, &residuals(unit))]).unwrap() / unit;
        assert!(sigma(1e-6) > 1.0 && (sigma(1e-6) / sigma(1.0) - 1.0).abs() < 1e-9, "{} {}", sigma(1e-6), sigma(1.0));
        assert_eq!(sample_sigma_g([(&run, &residuals(1e-9))]), None);
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
