//! What a model makes of a change of its signal.

use super::parts::{ModelDomain, ModelScaling};
use firmware_core::Network;
use protocol::Weights;

/// A model that was told its scale factor may differ from it by this factor.
const AGREES_WITHIN: f64 = 2.0;

/// The slope of a model's static part.
pub struct SlopeOf<'a> {
    scaling: &'a ModelScaling,
    domain: &'a ModelDomain,
    network: Network<f64>,
}

impl<'a> SlopeOf<'a> {
    pub(super) fn new(scaling: &'a ModelScaling, domain: &'a ModelDomain, weights: &Weights) -> Self {
        Self { scaling, domain, network: Network::new(weights) }
    }

    /// ∂a/∂Δf, g/Hz, at a frequency difference in µHz and a temperature in µ°C.
    #[must_use]
    pub fn at(&self, delta_f_uhz: f64, temperature_uc: f64) -> f64 {
        let scaling = self.scaling;
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
        let ModelDomain { delta_f_uhz: [f_low, f_high], temperature_uc: [t_low, t_high], .. } = *self.domain;
        self.at(f64::midpoint(f_low as f64, f_high as f64), f64::midpoint(f64::from(t_low), f64::from(t_high)))
    }

    /// Whether the model reads with the scale factor that it was told, as far as it was told any. A model of a sensor at
    /// rest has seen no change of the reference: nothing else would notice that it has lost its slope.
    pub(super) fn agrees_with(&self, stated_hz_per_g: Option<f64>) -> bool {
        let Some(stated) = stated_hz_per_g else { return true };
        let ratio = self.in_the_middle() * stated;
        (AGREES_WITHIN.recip()..=AGREES_WITHIN).contains(&ratio)
    }
}
