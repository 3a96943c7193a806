//! `thermal-gradient`: while the temperature moves, the two forks are not equally warm.
//!
//! ```text
//! T1 − T2 = δτ·dT/dt        ΔB = K·dT/dt,   K = S_g·δτ
//! ```
//!
//! Acts on the difference of the forks' temperatures, to which the bias reacts thirty times more than
//! to their mean; the sum of the frequencies does not see it. Typical: 20–500 µg/(K/min), from a δτ of
//! a fraction of a second. Kim & Jung, Sensors 25, 6131; Zhang et al., Micromachines 16, 241.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `thermal-gradient`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ThermalGradient {
    /// K: bias at the reference temperature while it moves by 1 K/min, µg/(K/min).
    pub ug_per_k_per_min: f64,
    /// Change of K with temperature, µg/(K/min)/K.
    pub ug_per_k_per_min_per_k: f64,
}

impl Default for ThermalGradient {
    fn default() -> Self {
        Self { ug_per_k_per_min: 100.0, ug_per_k_per_min_per_k: 0.0 }
    }
}

impl Switch for ThermalGradient {
    const NAME: &'static str = "thermal-gradient";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_k_per_min", self.ug_per_k_per_min, -1e5, 1e5)?;
        within("ug_per_k_per_min_per_k", self.ug_per_k_per_min_per_k, -1e4, 1e4)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            ug_per_k_per_min: self.ug_per_k_per_min * factor,
            ug_per_k_per_min_per_k: self.ug_per_k_per_min_per_k * factor,
        }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let reference_c = setting.truth.reference_temperature_c;
        let ug_per_k = setting.map.gradient_sensitivity_g_per_k(reference_c) * 1e6;
        Box::new(Uneven { of: self.clone(), reference_c, ug_per_k })
    }
}

struct Uneven {
    of: ThermalGradient,
    reference_c: f64,
    /// S_g: bias for 1 K between the forks, µg/K.
    ug_per_k: f64,
}

impl Effect for Uneven {
    fn act(&self, now: &Conditions, input: &mut Input) {
        let theta_k = now.sensor_c - self.reference_c;
        let ug_per_k_per_min = self.of.ug_per_k_per_min + self.of.ug_per_k_per_min_per_k * theta_k;
        let bias_ug = ug_per_k_per_min * now.sensor_rate_c_per_s * 60.0;
        input.gradient_k += bias_ug / self.ug_per_k;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn one_kelvin_a_minute_is_100_micro_g_and_the_sum_stays() {
        let mut alone = OneEffect::new(&ThermalGradient::default());
        alone.ramp(10.0, 600.0);
        let seen = alone.look();
        // S_g at 35 °C is 1 % above that at 25 °C.
        assert!((seen.bias_ug - 100.0).abs() < 1.5, "{seen:?}");
        // 3.5 mK between the forks and 2.4 Hz/K, halved twice and opposed: what is left is the mismatch.
        assert!(seen.mean_hz.abs() < 2e-4, "{seen:?}");
    }

    #[test]
    fn at_rest_there_is_nothing() {
        let mut alone = OneEffect::new(&ThermalGradient::default());
        alone.pass(10.0);
        assert!(alone.look().bias_ug.abs() < 1e-6);
    }
}
