//! Is it still an accelerometer? The model's local slope against the measured scale factor.
//!
//! A network can fit −1, 0 and +1 g to a few µg and be wrong by a tenth of a g in between. What gives
//! it away is its slope ∂a/∂Δf, which for a working sensor is 1/K1(T) everywhere.

use crate::campaign::Campaign;
use crate::fit::dataset::InputScale;
use crate::fit::neighbours::merged;
use crate::fit::polynomial::Polynomial;
use crate::metrics::levels::level_width;
use crate::model::{Model, SlopeOf};
use serde::Serialize;

/// What the figures mean.
pub const DEFINITION: &str = "deviation of the local slope ∂a/∂Δf of the model from 1/K1(T, Δf) as a polynomial fit \
    (Δf² · T³) measures it on all runs of the campaign, over a grid on the calibrated domain, in ppm of 1/K1.";

/// How faithful the local sensitivity is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sensitivity {
    /// Root mean square over the grid, ppm.
    pub rms: f64,
    /// Largest over the grid, ppm.
    pub worst: f64,
}

/// Points of the grid along each input.
const GRID: i32 = 41;

/// The model's slope over the calibrated domain against the campaign's own scale factor; `None` where
/// the campaign can't measure one because its reference never varies.
#[must_use]
pub fn sensitivity(model: &Model, campaign: &Campaign) -> Option<Sensitivity> {
    let error = SlopeError::new(model, campaign)?;
    Some(over_grid(model, |delta_f_uhz, temperature_uc| error.ppm_at(delta_f_uhz, temperature_uc)))
}

/// How far a model's slope is from the one that a campaign measures.
pub struct SlopeError<'a> {
    slope: SlopeOf<'a>,
    measured: Polynomial,
    scale: InputScale,
}

impl<'a> SlopeError<'a> {
    /// `None` where the campaign measures no scale factor because its reference never varies.
    #[must_use]
    pub fn new(model: &'a Model, campaign: &Campaign) -> Option<Self> {
        let references: Vec<f64> = campaign.rows().map(|row| row.reference_g).collect();
        if campaign.levels(level_width(&references)).len() < 2 {
            return None;
        }
        let scale = InputScale::of(&campaign.runs)?;
        let data = merged(campaign.runs.iter().enumerate(), &scale);
        Some(Self { slope: model.slope(), measured: Polynomial::fit(&data), scale })
    }

    /// ppm of the measured slope, at a frequency difference in µHz and a temperature in µ°C.
    #[must_use]
    pub fn ppm_at(&self, delta_f_uhz: f64, temperature_uc: f64) -> f64 {
        let scale = &self.scale;
        let x = (delta_f_uhz - scale.delta_f_zero_uhz as f64) * 1e-6 / scale.delta_f_half_span_hz;
        let t = (temperature_uc - f64::from(scale.temperature_zero_uc)) * 1e-6 / scale.temperature_half_span_c;
        let measured_g_per_hz = self.measured.slope(x, t) / scale.delta_f_half_span_hz;
        (self.slope.at(delta_f_uhz, temperature_uc) / measured_g_per_hz - 1.0) * 1e6
    }
}

/// The model's slope over its domain against `truth_g_per_hz(delta_f_uhz, temperature_uc)`.
pub fn over_domain(model: &Model, truth_g_per_hz: impl Fn(f64, f64) -> f64) -> Sensitivity {
    let slope = model.slope();
    over_grid(model, |f, t| (slope.at(f, t) / truth_g_per_hz(f, t) - 1.0) * 1e6)
}

fn over_grid(model: &Model, ppm_at: impl Fn(f64, f64) -> f64) -> Sensitivity {
    let [f_low, f_high] = model.domain.delta_f_uhz.map(|uhz| uhz as f64);
    let [t_low, t_high] = model.domain.temperature_uc.map(f64::from);
    let (mut squares, mut worst) = (0.0, 0.0_f64);
    for (i, j) in (0..GRID).flat_map(|i| (0..GRID).map(move |j| (i, j))) {
        let part = |k: i32| f64::from(k) / f64::from(GRID - 1);
        let ppm = ppm_at(f_low + (f_high - f_low) * part(i), t_low + (t_high - t_low) * part(j));
        squares += ppm * ppm;
        worst = worst.max(ppm.abs());
    }
    Sensitivity { rms: (squares / f64::from(GRID * GRID)).sqrt(), worst }
}
