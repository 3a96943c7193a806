//! What the optimisers eat: scaled inputs and references.

use crate::campaign::{Row, Run};
use protocol::Sample;

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

/// Half spans of temperature below this are widened to it: a thermometer's noise is no span to divide by, °C.
const LEAST_HALF_SPAN_C: f64 = 1e-3;
/// And of the signal, be its unit as large as it will: one step of what holds it.
const LEAST_HALF_SPAN: f64 = 1e-6;

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
        let half = |span: f64, least: f64| (span / 2e6).max(least);
        Some(Self {
            delta_f_zero_uhz: i64::midpoint(f_low, f_high),
            delta_f_half_span_hz: half(f_high.abs_diff(f_low) as f64, LEAST_HALF_SPAN),
            temperature_zero_uc: i32::midpoint(t_low, t_high),
            temperature_half_span_c: half(f64::from(t_high) - f64::from(t_low), LEAST_HALF_SPAN_C),
        })
    }

    /// Scaled inputs (x, t) of a sample.
    #[must_use]
    pub fn inputs(&self, sample: &Sample) -> [f64; 2] {
        let delta_f_uhz = sample.delta_f_uhz.saturating_sub(self.delta_f_zero_uhz) as f64;
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

/// The mean of neighbouring rows.
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
