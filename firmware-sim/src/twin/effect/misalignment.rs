//! `misalignment`: the input axis does not point where the case says.
//!
//! ```text
//! a = a_i·cos ψ + a_p·sin ψ,   ψ = ψ0 + ψ1·(T − T0)
//! ```
//!
//! Acts on the applied acceleration. In one mounting it looks like an error of the dividing head's zero; turning the
//! device by 180° about its input axis tells them apart. Typical: 0.1–10 mrad, 0.1–5 µrad/K. IEEE Std 1293, δ.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `misalignment`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Misalignment {
    /// ψ0: angle between input axis and case, towards the pendulous axis, µrad.
    pub angle_urad: f64,
    /// ψ1: change of that angle with temperature, µrad/K.
    pub angle_urad_per_k: f64,
}

impl Default for Misalignment {
    fn default() -> Self {
        Self { angle_urad: 100.0, angle_urad_per_k: 0.0 }
    }
}

impl Switch for Misalignment {
    const NAME: &'static str = "misalignment";

    fn check(&self) -> Result<(), Fault> {
        within("angle_urad", self.angle_urad, -2e5, 2e5)?;
        within("angle_urad_per_k", self.angle_urad_per_k, -1e3, 1e3)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { angle_urad: self.angle_urad * factor, angle_urad_per_k: self.angle_urad_per_k * factor }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(Askew { of: self.clone(), reference_c: setting.truth.reference_temperature_c })
    }
}

struct Askew {
    of: Misalignment,
    reference_c: f64,
}

impl Effect for Askew {
    fn act(&self, now: &Conditions, input: &mut Input) {
        let theta_k = now.sensor_c - self.reference_c;
        let (sine, cosine) = ((self.of.angle_urad + self.of.angle_urad_per_k * theta_k) * 1e-6).sin_cos();
        input.acceleration_g += now.applied_g * (cosine - 1.0) + now.position.cross_g * sine;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn level_it_reads_the_angle_upright_the_square_of_it() {
        let mut alone = OneEffect::new(&Misalignment { angle_urad: 2000.0, ..Misalignment::default() });
        for (angle_deg, worked_ug) in [(0.0, 2000.0), (90.0, -2.0), (180.0, -2000.0)] {
            alone.apply(angle_deg);
            assert!((alone.look().bias_ug - worked_ug).abs() < 0.002, "{angle_deg}°");
        }
    }
}
