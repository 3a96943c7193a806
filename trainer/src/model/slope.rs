//! What a model makes of a change of its signal.

use super::{Model, ModelDomain};
use firmware_core::Network;

/// The slope of a model's static part.
pub struct SlopeOf<'a> {
    model: &'a Model,
    network: Network<f64>,
}

impl<'a> SlopeOf<'a> {
    /// Of this model.
    #[must_use]
    pub fn new(model: &'a Model) -> Self {
        Self { model, network: Network::new(&model.weights()) }
    }

    /// ∂a/∂Δf, g/Hz, at a frequency difference in µHz and a temperature in µ°C.
    #[must_use]
    pub fn at(&self, delta_f_uhz: f64, temperature_uc: f64) -> f64 {
        let scaling = &self.model.scaling;
        let x_per_hz = f64::from(scaling.delta_f_gain_per_hz);
        let x = (delta_f_uhz - scaling.delta_f_zero_uhz as f64) * 1e-6 * x_per_hz;
        let t = (temperature_uc - f64::from(scaling.temperature_zero_uc))
            * 1e-6
            * f64::from(scaling.temperature_gain_per_c);
        let [_, by_x, _, by_xt] = scaling.line_g.map(f64::from);
        (by_x + by_xt * t + f64::from(scaling.output_g) * self.network.gradient(x, t)[0]) * x_per_hz
    }

    /// The same in the middle of the calibrated domain.
    #[must_use]
    pub fn in_the_middle(&self) -> f64 {
        let ModelDomain { delta_f_uhz: [f_low, f_high], temperature_uc: [t_low, t_high], .. } = self.model.domain;
        self.at(f64::midpoint(f_low as f64, f_high as f64), f64::midpoint(f64::from(t_low), f64::from(t_high)))
    }
}

/// A model that was told its scale factor may differ from it by this factor.
const AGREES_WITHIN: f64 = 2.0;

/// Whether the model reads with the scale factor that it was told, as far as it was told any. A model of a sensor at rest
/// has seen no change of the reference: nothing else would notice that it has lost its slope.
pub(super) fn agrees_with_what_was_stated(model: &Model) -> bool {
    let Some(stated) = model.provenance.scale_factor_hz_per_g else { return true };
    let ratio = SlopeOf::new(model).in_the_middle() * stated;
    (AGREES_WITHIN.recip()..=AGREES_WITHIN).contains(&ratio)
}
