//! Whether what is left swings with a period.

use super::case::{Case, Noises};
use super::evidence::Bench;
use super::instrument::Known;

/// Frequencies per independent one.
const OVERSAMPLING: f64 = 3.0;
/// Most frequencies that are looked at.
const MOST: usize = 4000;
/// A peak must exceed what chance gives among all frequencies by this.
const PEAK: f64 = 12.0;

impl Case<'_> {
    /// The period of the whitened residual, s, if one frequency stands out. Phases may differ from run to run.
    pub fn period_s(&self, known: &Known, noises: &Noises) -> Option<f64> {
        let bench =
            Bench::new(&self.layout, noises.delta.small(), &self.left(known).delta, &self.adapting(known).delta)?;
        let innovations = bench.innovations();
        let runs: Vec<(Vec<f64>, &Vec<f64>)> = self
            .layout
            .stretches
            .iter()
            .zip(&innovations)
            .filter(|(stretch, _)| stretch.cells.len() >= LEAST_CELLS)
            .map(|(stretch, values)| (stretch.cells.iter().map(|cell| cell.time_s).collect(), values))
            .collect();
        let longest_s = runs.iter().filter_map(|(times, _)| Some(times.last()? - times.first()?)).fold(0.0, f64::max);
        let steps = runs.iter().flat_map(|(times, _)| times.windows(2).map(|pair| pair[1] - pair[0]));
        let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        if steps.is_empty() || longest_s <= 0.0 {
            return None;
        }
        steps.sort_unstable_by(f64::total_cmp);
        let fastest = 0.5 / steps[steps.len() / 2];
        let count = ((fastest * longest_s * OVERSAMPLING) as usize).min(MOST);
        let powers = (3..=count).map(|k| k as f64 / (longest_s * OVERSAMPLING)).map(|frequency| {
            let power: f64 = runs.iter().map(|(times, values)| power(times, values, frequency)).sum();
            (frequency, power)
        });
        let (frequency, peak) = powers.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (freedom, scale) = (runs.len() as f64, spread(&innovations));
        let threshold = freedom + (2.0 * freedom).sqrt() * 4.0 + (count as f64).ln() + PEAK;
        (peak / scale > threshold).then(|| frequency.recip())
    }
}

/// Shorter runs have no period.
const LEAST_CELLS: usize = 8;

/// Periodogram at one frequency, 1 on average for white noise of variance one.
fn power(times: &[f64], values: &[f64], frequency: f64) -> f64 {
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (time, value) in times.iter().zip(values) {
        let (s, c) = (2.0 * std::f64::consts::PI * frequency * time).sin_cos();
        sine += s * value;
        cosine += c * value;
    }
    (sine * sine + cosine * cosine) / values.len() as f64
}

/// Variance by the median: a few large values don't hide a swing.
fn spread(innovations: &[Vec<f64>]) -> f64 {
    let mut squares: Vec<f64> = innovations.iter().flatten().map(|value| value * value).collect();
    squares.sort_unstable_by(f64::total_cmp);
    squares.get(squares.len() / 2).map_or(1.0, |median| (median / 0.454_9).max(1e-12))
}
