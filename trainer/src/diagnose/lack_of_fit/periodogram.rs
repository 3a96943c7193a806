//! Whether what is left is periodic with a period, be it of seconds or of days.
//!
//! A periodogram of the whitened residual, sample by sample and octave by octave. Phases may differ from run to run and
//! drift within one: runs are cut into segments of [`PERIODS`], whose powers are added. Within an octave, samples are
//! gathered in bins of an eighth of its shortest period, so that a long record costs no more than a short one.

use super::structure::LackOfFit;
use crate::diagnose::cells::{Cell, Columns, RunCells};
use crate::diagnose::forward::EffectSet;
use crate::diagnose::noise::{Component, InitialStates, NoiseModel, Whitening};
use crate::diagnose::problem::{NoiseModels, Problem, constrained};
use crate::diagnose::regression::Gls;
use crate::diagnose::thresholds::{
    BINS_PER_PERIOD, CHANCE_SIGMA, LEAST_SEGMENT_PERIODS, LEAST_SEGMENT_SAMPLES, OVERSAMPLING, SEGMENT_PERIODS,
};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The whitened residual of one run: times from its beginning, s, and values.
struct Course {
    times_s: Vec<f64>,
    values: Vec<f64>,
    /// Between samples, median.
    step_s: f64,
}

/// Samples gathered: mean time, sum of the values, how many.
#[derive(Clone, Copy)]
struct Bin {
    time_s: f64,
    sum: f64,
    samples: f64,
}

/// One frequency's power: 1 a segment on average, if nothing is periodic.
struct Peak {
    frequency_hz: f64,
    power: f64,
    /// What most frequencies of its octave have: wander raises them all, a swing only its own.
    background: f64,
    segments: f64,
    samples: f64,
}

impl Peak {
    fn excess(&self) -> f64 {
        self.power - self.segments - CHANCE_SIGMA * (2.0 * self.segments).sqrt()
    }
}

/// The periodic component that stands out most.
pub fn periodic(problem: &Problem, known: &EffectSet, noises: &NoiseModels) -> Option<LackOfFit> {
    let courses = courses(problem, known, noises)?;
    let peaks = octaves(&courses);
    let frequencies: usize = peaks.iter().map(|(count, _)| count).sum();
    let scale = spread(&courses);
    let peaks = peaks.into_iter().map(|(_, peak)| Peak { power: peak.power / scale.max(peak.background), ..peak });
    let best = peaks.max_by(|a, b| a.excess().total_cmp(&b.excess()))?;
    Some(LackOfFit {
        depends_on: vec!["time_s".to_owned()],
        period_s: Some(best.frequency_hz.recip()),
        delta_bic: 2.0 * (best.excess() - (frequencies as f64).ln()),
        size_ug: problem.sample_ug
            * (2.0 * (best.power - best.segments).max(0.0) * scale.max(best.background) / best.samples).sqrt(),
    })
}

/// The residual sample by sample, what the map makes of it taken out; white but for what is periodic.
fn courses(problem: &Problem, known: &EffectSet, noises: &NoiseModels) -> Option<Vec<Course>> {
    let (cells, noise) = (problem.cells(), noises.delta.calm());
    let (residual, nuisance) = (problem.forward.residuals(known).delta, constrained(problem, known, noises).delta);
    let adapted = Gls::new(cells, &noises.initial, &noise, &residual, &nuisance)?.adapted(&residual, &nuisance);
    let fine = cells.by_sample();
    let mut values: Columns = problem.forward.residual_in_ug(&fine, known);
    for (index, run) in cells.runs.iter().enumerate() {
        for (row, cell) in run.cells.iter().enumerate() {
            let change = adapted[index][(row, 0)] - residual[index][(row, 0)];
            cell.rows.clone().for_each(|row| values[index][(row, 0)] += change);
        }
    }
    let white = Whitening::new(&fine, &InitialStates::of(&fine, known), &noise).of(&values);
    let course = |(run, values): (&RunCells, &DMatrix<f64>)| {
        let moved = cells.may_turn_unseen() && run.is_moved();
        let samples = run.cells.iter().zip(values.iter());
        Course::new(samples.filter(|(cell, _)| !(moved && shows_rig(cell, &noises.delta))))
    };
    Some(fine.runs.iter().zip(&white).filter_map(course).collect())
}

/// Whether a rig that is turned to and fro, unseen, shows here above the noise: it keeps time as well as anything.
fn shows_rig(cell: &Cell, noise: &NoiseModel) -> bool {
    noise[Component::Position].max(noise[Component::Turn]) * cell.cross_g > noise.sample
}

impl Course {
    /// `None` for less than two samples.
    fn new<'a>(samples: impl Iterator<Item = (&'a Cell, &'a f64)>) -> Option<Self> {
        let (times_s, values): (Vec<f64>, Vec<f64>) = samples.map(|(cell, value)| (cell.time_s, *value)).unzip();
        let mut steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        steps.sort_unstable_by(f64::total_cmp);
        let step_s = *steps.get(steps.len() / 2)?;
        Some(Self { times_s, values, step_s })
    }

    fn seconds(&self) -> f64 {
        self.times_s.last().copied().unwrap_or_default()
    }

    /// Cut into segments of `segment_s`, gathered in bins of `bin_s`; those that are long enough for `period_s`.
    fn segments(&self, segment_s: f64, bin_s: f64, period_s: f64) -> Vec<Vec<Bin>> {
        let mut found: Vec<(usize, Vec<Bin>)> = Vec::new();
        for (time_s, value) in self.times_s.iter().zip(&self.values) {
            let number = (time_s / segment_s) as usize;
            if found.last().is_none_or(|(last, _)| *last != number) {
                found.push((number, Vec::new()));
            }
            let Some((_, bins)) = found.last_mut() else { continue };
            match bins.last_mut() {
                Some(bin) if (bin.time_s / bin_s).floor() == (time_s / bin_s).floor() => bin.take(*time_s, *value),
                _ => bins.push(Bin { time_s: *time_s, sum: *value, samples: 1.0 }),
            }
        }
        let is_long = |bins: &Vec<Bin>| {
            let (Some(first), Some(last)) = (bins.first(), bins.last()) else { return false };
            let samples: f64 = bins.iter().map(|bin| bin.samples).sum();
            last.time_s - first.time_s >= LEAST_SEGMENT_PERIODS * period_s && samples >= LEAST_SEGMENT_SAMPLES
        };
        found.into_iter().map(|(_, bins)| bins).filter(is_long).collect()
    }
}

impl Bin {
    fn take(&mut self, time_s: f64, value: f64) {
        self.sum += value;
        self.time_s += (time_s - self.time_s) / (self.samples + 1.0);
        self.samples += 1.0;
    }
}

/// Of every octave: how many frequencies were looked at, and the best.
fn octaves(courses: &[Course]) -> Vec<(usize, Peak)> {
    let longest_s = courses.iter().map(Course::seconds).fold(0.0, f64::max);
    let fastest_hz = courses.iter().map(|course| 0.5 / course.step_s).fold(0.0, f64::max);
    let slowest_hz = LEAST_SEGMENT_PERIODS / longest_s.max(f64::MIN_POSITIVE);
    let starts = std::iter::successors(Some(fastest_hz / 2.0), |start| Some(start / 2.0));
    starts.take_while(|start| *start > slowest_hz).filter_map(|start| octave(courses, start, longest_s)).collect()
}

/// From `start_hz` to twice that.
fn octave(courses: &[Course], start_hz: f64, longest_s: f64) -> Option<(usize, Peak)> {
    let (longest_period_s, shortest_period_s) = (start_hz.recip(), 0.5 / start_hz);
    let segment_s = (SEGMENT_PERIODS * longest_period_s).min(longest_s * 1.01);
    let resolved = courses.iter().filter(|course| course.step_s <= 0.5 * shortest_period_s * 1.01);
    let segments: Vec<Vec<Bin>> = resolved
        .flat_map(|course| course.segments(segment_s, shortest_period_s / BINS_PER_PERIOD, longest_period_s))
        .collect();
    if segments.is_empty() {
        return None;
    }
    let count = (start_hz * segment_s * OVERSAMPLING).ceil() as usize;
    let samples = segments.iter().flatten().map(|bin| bin.samples).sum();
    let powers = (0..count).into_par_iter().map(|k| {
        let frequency_hz = start_hz * (1.0 + k as f64 / count as f64);
        (frequency_hz, segments.iter().map(|bins| power(bins, frequency_hz)).sum::<f64>())
    });
    let mut powers: Vec<(f64, f64)> = powers.collect();
    powers.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    let (frequency_hz, power) = *powers.last()?;
    let segments = segments.len() as f64;
    // Of a sum of exponentials, the median is a third below the mean.
    let background = powers[powers.len() / 2].1 / (segments - 1.0 / 3.0);
    Some((count, Peak { frequency_hz, power, background, segments, samples }))
}

/// Periodogram of one segment, 1 on average for white noise of variance one.
fn power(bins: &[Bin], frequency_hz: f64) -> f64 {
    let (mut sine, mut cosine, mut samples) = (0.0, 0.0, 0.0);
    for bin in bins {
        let (s, c) = (TAU * frequency_hz * bin.time_s).sin_cos();
        sine += s * bin.sum;
        cosine += c * bin.sum;
        samples += bin.samples;
    }
    (sine * sine + cosine * cosine) / samples
}

/// Variance by the median: a few large values don't hide a swing.
fn spread(courses: &[Course]) -> f64 {
    let mut squares: Vec<f64> = courses.iter().flat_map(|course| &course.values).map(|value| value * value).collect();
    squares.sort_unstable_by(f64::total_cmp);
    squares.get(squares.len() / 2).map_or(1.0, |median| (median / 0.454_9).max(1e-12))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise of variance one at every second, and a swing.
    fn course(amplitude: f64, period_s: f64) -> Course {
        let mut state = 7_u32;
        let mut uniform = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) - 0.5
        };
        let noise: Vec<f64> = (0..4000).map(|_| (0..12).map(|_| uniform()).sum()).collect();
        let times_s: Vec<f64> = (0..4000).map(f64::from).collect();
        let swing = |time_s: &f64| amplitude * (TAU * time_s / period_s + 1.0).sin();
        let values = times_s.iter().zip(noise).map(|(time_s, noise)| noise + swing(time_s)).collect();
        Course { times_s, values, step_s: 1.0 }
    }

    fn best(course: Course) -> Peak {
        octaves(&[course]).into_iter().map(|(_, peak)| peak).max_by(|a, b| a.excess().total_cmp(&b.excess())).unwrap()
    }

    #[test]
    fn a_period_of_half_the_noise_stands_out_at_its_period_and_noise_does_not() {
        for period_s in [5.3, 61.0, 412.0, 1500.0] {
            let peak = best(course(0.5, period_s));
            assert!(peak.excess() > 50.0, "{period_s}: {}", peak.excess());
            assert!(
                (peak.frequency_hz.recip() / period_s - 1.0).abs() < 0.1,
                "{period_s}: {}",
                peak.frequency_hz.recip()
            );
        }
        assert!(best(course(0.0, 61.0)).excess() < 9.0);
    }
}
