//! What the optimisers eat: scaled inputs and references, neighbours merged.

use crate::campaign::{Row, Run};
use protocol::Sample;
use std::ops::Range;

/// Zeros and half spans of the inputs over the training runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputScale {
    /// Frequency difference at x = 0, µHz.
    pub delta_f_zero_uhz: i64,
    /// Hz from the zero to x = 1.
    pub delta_f_half_span_hz: f64,
    /// Temperature at t = 0, µ°C.
    pub temperature_zero_uc: i32,
    /// °C from the zero to t = 1.
    pub temperature_half_span_c: f64,
}

/// Half spans below this are widened to it: a still sensor has no span to divide by.
const LEAST_HALF_SPAN: f64 = 1e-3;

impl InputScale {
    /// Centres and half spans such that all samples lie within ±1; `None` without samples.
    #[must_use]
    pub fn of<'a>(runs: impl IntoIterator<Item = &'a Run>) -> Option<Self> {
        let mut samples = runs.into_iter().flat_map(|run| &run.rows).map(|row| &row.sample);
        let first = samples.next()?;
        let start = (first.delta_f_uhz, first.delta_f_uhz, first.temperature_uc, first.temperature_uc);
        let (f_low, f_high, t_low, t_high) = samples.fold(start, |(a, b, c, d), sample| {
            let (f, t) = (sample.delta_f_uhz, sample.temperature_uc);
            (a.min(f), b.max(f), c.min(t), d.max(t))
        });
        let half = |span: f64| (span / 2e6).max(LEAST_HALF_SPAN);
        Some(Self {
            delta_f_zero_uhz: i64::midpoint(f_low, f_high),
            delta_f_half_span_hz: half((f_high - f_low) as f64),
            temperature_zero_uc: i32::midpoint(t_low, t_high),
            temperature_half_span_c: half(f64::from(t_high) - f64::from(t_low)),
        })
    }

    /// Scaled inputs (x, t) of a sample.
    #[must_use]
    pub fn inputs(&self, sample: &Sample) -> [f64; 2] {
        let delta_f_uhz = (sample.delta_f_uhz - self.delta_f_zero_uhz) as f64;
        let temperature_uc = f64::from(sample.temperature_uc) - f64::from(self.temperature_zero_uc);
        [delta_f_uhz * 1e-6 / self.delta_f_half_span_hz, temperature_uc * 1e-6 / self.temperature_half_span_c]
    }
}

/// One observation for an optimiser: a sample, or the mean of neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Datum {
    /// Scaled frequency difference.
    pub x: f64,
    /// Scaled temperature.
    pub t: f64,
    /// Applied acceleration, g.
    pub reference_g: f64,
    /// Samples that it stands for.
    pub weight: f64,
    /// Index of its run in the campaign.
    pub run: usize,
}

/// Neighbours are merged while they lie within this much of the scaled inputs.
///
/// The mean of a function over a cell differs from the function at the cell's mean by curvature ·
/// width²/24: with a departure from the line of 10 mg that is below 0.01 µg.
const CELL: f64 = 0.01;
/// And while at most this many samples are merged,
const MOST_MERGED: usize = 128;
/// and this many minutes, so that slow drifts keep their shape.
const MOST_MINUTES: f64 = 10.0;

/// Scaled data of one run, consecutive neighbours at the same reference merged into their mean.
///
/// A least-squares fit sees the same normal equations up to the curvature within a cell, and what a
/// soaked state at 1 Hz repeats thirty times is computed once.
#[must_use]
pub fn merged(run: &Run, index: usize, scale: &InputScale) -> Vec<Datum> {
    cells(run, scale).into_iter().map(|cell| mean(&run.rows[cell], index, scale)).collect()
}

/// The stretches of a run that [`merged`] takes the means of.
#[must_use]
pub fn cells(run: &Run, scale: &InputScale) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    while let Some(first) = run.rows.get(start) {
        let joins = |row: &Row| is_neighbour(first, row, scale);
        let length = run.rows[start..].iter().take(MOST_MERGED).take_while(|row| joins(row)).count();
        found.push(start..start + length);
        start += length;
    }
    found
}

fn is_neighbour(first: &Row, row: &Row, scale: &InputScale) -> bool {
    let ([x0, t0], [x, t]) = (scale.inputs(&first.sample), scale.inputs(&row.sample));
    let minutes = row.sample.time_us.abs_diff(first.sample.time_us) as f64 / 60e6;
    (x - x0).abs() < CELL
        && (t - t0).abs() < CELL
        && (row.reference_g - first.reference_g).abs() < CELL
        && row.sample.channels.iter().zip(&first.sample.channels).all(|(a, b)| is_near(*a, *b))
        && minutes < MOST_MINUTES
}

/// Auxiliary channels within half a per cent.
fn is_near(a: i64, b: i64) -> bool {
    a.abs_diff(b) <= b.unsigned_abs() / 200
}

pub(crate) fn mean(rows: &[Row], run: usize, scale: &InputScale) -> Datum {
    let count = rows.len() as f64;
    let mut sum = Datum { x: 0.0, t: 0.0, reference_g: 0.0, weight: count, run };
    for row in rows {
        let [x, t] = scale.inputs(&row.sample);
        sum.x += x / count;
        sum.t += t / count;
        sum.reference_g += row.reference_g / count;
    }
    sum
}

/// All rows of a run as data of weight one.
pub fn single(run: &Run, index: usize, scale: &InputScale) -> impl Iterator<Item = Datum> {
    run.rows.iter().map(move |row| mean(std::slice::from_ref(row), index, scale))
}
