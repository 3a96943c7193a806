//! Neighbouring samples that an optimiser may take for one.
//!
//! A least-squares fit sees the same normal equations up to the curvature within a cell, and what a soaked state at
//! 1 Hz repeats thirty times is computed once.

use super::dataset::{Datum, InputScale, mean};
use crate::campaign::{Row, Run};
use crate::noise::normal_sigma;
use protocol::Sample;
use protocol::limits::MAX_CHANNELS;
use std::ops::Range;

/// Neighbours are merged while they lie within this much of the scaled inputs.
///
/// The mean of a function over a cell differs from the function at the cell's mean by curvature ·
/// width²/24: with a departure from the line of 10 mg that is below 0.01 µg.
const CELL: f64 = 0.01;
/// And while at most this many samples are merged,
const MOST_MERGED: usize = 128;
/// and this many minutes, so that slow drifts keep their shape.
const MOST_MINUTES: f64 = 10.0;
/// Two values of an auxiliary channel are the same if they differ by less than this share,
const SAME: f64 = 0.005;
/// or by less than so many standard deviations of the channel's own noise,
const SCATTERS: f64 = 5.0;
/// if that is less than this share of all that the channel does: what was set anew for each sample is no noise.
const MOST_SCATTER: f64 = 0.05;

/// Says which samples of some runs are neighbours.
pub struct Neighbours {
    scale: InputScale,
    /// Of each auxiliary channel over all runs.
    spans: [f64; MAX_CHANNELS],
}

impl Neighbours {
    /// Of these runs.
    #[must_use]
    pub fn of<'a>(runs: impl IntoIterator<Item = &'a Run>, scale: &InputScale) -> Self {
        let mut ranges = [(i64::MAX, i64::MIN); MAX_CHANNELS];
        for row in runs.into_iter().flat_map(|run| &run.rows) {
            for ((low, high), &value) in ranges.iter_mut().zip(&row.sample.channels) {
                if value != Sample::NOT_MEASURED {
                    (*low, *high) = ((*low).min(value), (*high).max(value));
                }
            }
        }
        Self { scale: *scale, spans: ranges.map(|(low, high)| high.abs_diff(low) as f64) }
    }

    /// Stretches of consecutive neighbours at the same reference.
    #[must_use]
    pub fn cells(&self, run: &Run) -> Vec<Range<usize>> {
        let noises = std::array::from_fn(|channel| noise(run, channel, self.spans[channel]));
        let mut found = Vec::new();
        let mut start = 0;
        while let Some(first) = run.rows.get(start) {
            let joins = |row: &&Row| self.join(first, row, &noises);
            let length = run.rows[start..].iter().take(MOST_MERGED).take_while(joins).count();
            found.push(start..start + length);
            start += length;
        }
        found
    }

    fn join(&self, first: &Row, row: &Row, noises: &[f64; MAX_CHANNELS]) -> bool {
        let ([x0, t0], [x, t]) = (self.scale.inputs(&first.sample), self.scale.inputs(&row.sample));
        let minutes = row.sample.time_us.abs_diff(first.sample.time_us) as f64 / 60e6;
        let mut channels = row.sample.channels.iter().zip(&first.sample.channels).zip(noises);
        (x - x0).abs() < CELL
            && (t - t0).abs() < CELL
            && (row.reference_g - first.reference_g).abs() < CELL
            && minutes < MOST_MINUTES
            && channels.all(|((a, b), noise)| {
                let apart = a.abs_diff(*b) as f64;
                apart <= SAME * b.unsigned_abs() as f64 || apart <= *noise
            })
    }
}

/// The means of the cells of these runs, each with its index.
#[must_use]
pub fn merged<'a>(runs: impl Iterator<Item = (usize, &'a Run)> + Clone, scale: &InputScale) -> Vec<Datum> {
    let neighbours = Neighbours::of(runs.clone().map(|(_, run)| run), scale);
    let of = |(index, run): (usize, &'a Run)| {
        neighbours.cells(run).into_iter().map(move |cell| mean(&run.rows[cell], index, scale)).collect::<Vec<_>>()
    };
    runs.flat_map(of).collect()
}

/// Up to where two values of a channel in this run may differ by noise: from the median of second differences, which
/// neither a slope nor a few steps disturb.
fn noise(run: &Run, channel: usize, span: f64) -> f64 {
    let bend = |rows: &[Row]| {
        let [before, here, after] = [0, 1, 2].map(|row| rows[row].sample.channels[channel] as f64);
        (before - 2.0 * here + after).abs()
    };
    let scatter = normal_sigma(run.rows.windows(3).map(bend).collect()) / 6.0_f64.sqrt();
    if SCATTERS * scatter > MOST_SCATTER * span { 0.0 } else { SCATTERS * scatter }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    const ROWS: usize = 200;

    /// A run at rest with one channel; 1 Hz.
    fn run(channel: impl Fn(usize) -> i64) -> Run {
        let row = |index: usize| {
            let mut sample = Sample::from_difference(index as u64 * 1_000_000, 0, 0);
            sample.channels[0] = channel(index);
            Row { sample, reference_g: 0.0, reference_sigma_g: None }
        };
        let rows = (0..ROWS).map(row).collect();
        Run { name: String::new(), kind: String::new(), source: PathBuf::new(), rows }
    }

    fn cells(of: &Run, beside: &Run) -> usize {
        let scale = InputScale::of([of]).unwrap();
        Neighbours::of([of, beside], &scale).cells(of).len()
    }

    /// Within ±50, without a pattern.
    fn scatter(index: usize) -> i64 {
        (index * 37 % 101) as i64 - 50
    }

    #[test]
    fn a_channels_own_noise_keeps_no_neighbours_apart_and_what_it_does_on_purpose_does() {
        let quiet = run(|_| 400);
        let noisy = run(|index| 400 + scatter(index));
        let far = run(|_| 40_000);
        let least = ROWS.div_ceil(MOST_MERGED);
        assert_eq!(cells(&quiet, &far), least);
        assert_eq!(cells(&noisy, &far), least);
        // All that the channel ever does may be what an effect follows.
        assert!(cells(&noisy, &quiet) > ROWS / 2);
        // Steps far beyond the noise part neighbours.
        let stepped = run(|index| 400 + scatter(index) + if index / 50 % 2 == 0 { 0 } else { 5_000 });
        assert_eq!(cells(&stepped, &far), 4);
    }
}
