//! `x-odd-quadratic`: the two directions of acceleration are not mirror images.
//!
//! ```text
//! ΔB = ½K0'·sgn a + ½K1'·|a| + K_oq·a·|a|
//! ```
//!
//! Acts as an acceleration, with a kink at 0 g. Typical: 0–50 µg, 0–100 ppm. IEEE Std 1293, K0', K1', K_oq.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `x-odd-quadratic`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OddQuadratic {
    /// K0': difference of the bias for the two directions, µg.
    pub bias_asymmetry_ug: f64,
    /// K1': difference of the scale factor for the two directions, ppm.
    pub scale_factor_asymmetry_ppm: f64,
    /// K_oq: odd quadratic coefficient, µg/g².
    pub ug_per_g2: f64,
}

impl Default for OddQuadratic {
    fn default() -> Self {
        Self { bias_asymmetry_ug: 0.0, scale_factor_asymmetry_ppm: 20.0, ug_per_g2: 0.0 }
    }
}

impl Switch for OddQuadratic {
    const NAME: &'static str = "x-odd-quadratic";

    fn check(&self) -> Result<(), Fault> {
        within("bias_asymmetry_ug", self.bias_asymmetry_ug, -1e5, 1e5)?;
        within("scale_factor_asymmetry_ppm", self.scale_factor_asymmetry_ppm, -1e5, 1e5)?;
        within("ug_per_g2", self.ug_per_g2, -1e5, 1e5)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            bias_asymmetry_ug: self.bias_asymmetry_ug * factor,
            scale_factor_asymmetry_ppm: self.scale_factor_asymmetry_ppm * factor,
            ug_per_g2: self.ug_per_g2 * factor,
        }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Kinked(self.clone()))
    }
}

struct Kinked(OddQuadratic);

impl Effect for Kinked {
    fn act(&self, now: &Conditions, input: &mut Input) {
        let Self(of) = self;
        let a_g = now.applied_g;
        // Rust's signum has no zero: at exactly 0 g there is no direction.
        let direction = if a_g == 0.0 { 0.0 } else { a_g.signum() };
        let kink_ug = of.bias_asymmetry_ug / 2.0 * direction
            + of.scale_factor_asymmetry_ppm / 2.0 * a_g.abs()
            + of.ug_per_g2 * a_g * a_g.abs();
        input.acceleration_g += kink_ug * 1e-6;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn both_directions_give_the_worked_values() {
        let all = OddQuadratic { bias_asymmetry_ug: 8.0, scale_factor_asymmetry_ppm: 20.0, ug_per_g2: 4.0 };
        let mut alone = OneEffect::new(&all);
        for (angle_deg, worked_ug) in [(0.0, 0.0), (30.0, 4.0 + 5.0 + 1.0), (270.0, -4.0 + 10.0 - 4.0)] {
            alone.apply(angle_deg);
            assert!((alone.look().bias_ug - worked_ug).abs() < 1e-6, "{angle_deg}°");
        }
    }
}
