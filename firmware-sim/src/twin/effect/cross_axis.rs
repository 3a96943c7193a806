//! `cross-axis`: acceleration along the pendulous axis leaks into the reading.
//!
//! ```text
//! ΔB = δ·a_p + K_ip·a_i·a_p + K_pp·a_p²
//! ```
//!
//! Acts as an acceleration. Typical: δ 0.1–10 mrad, K_ip 5–50 µg/g². IEEE Std 1293, δ_o, K_ip, K_pp; Safran MS1000 data
//! sheet; US 8,117,917.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `cross-axis`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CrossAxis {
    /// δ: linear sensitivity to the pendulous axis, µrad, which is µg/g.
    pub sensitivity_urad: f64,
    /// K_ip: product of input and pendulous axis, µg/g².
    pub product_ug_per_g2: f64,
    /// K_pp: square of the pendulous axis, µg/g².
    pub square_ug_per_g2: f64,
}

impl Default for CrossAxis {
    fn default() -> Self {
        Self { sensitivity_urad: 100.0, product_ug_per_g2: 20.0, square_ug_per_g2: 0.0 }
    }
}

impl Switch for CrossAxis {
    const NAME: &'static str = "cross-axis";

    fn check(&self) -> Result<(), Fault> {
        within("sensitivity_urad", self.sensitivity_urad, -1e5, 1e5)?;
        within("product_ug_per_g2", self.product_ug_per_g2, -1e5, 1e5)?;
        within("square_ug_per_g2", self.square_ug_per_g2, -1e5, 1e5)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            sensitivity_urad: self.sensitivity_urad * factor,
            product_ug_per_g2: self.product_ug_per_g2 * factor,
            square_ug_per_g2: self.square_ug_per_g2 * factor,
        }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Leaking(self.clone()))
    }
}

struct Leaking(CrossAxis);

impl Effect for Leaking {
    fn act(&self, now: &Conditions, input: &mut Input) {
        let Self(of) = self;
        let cross_g = now.position.cross_g;
        let per_cross = of.sensitivity_urad + of.product_ug_per_g2 * now.applied_g;
        let leak_ug = (per_cross + of.square_ug_per_g2 * cross_g) * cross_g;
        input.acceleration_g += leak_ug * 1e-6;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn a_tumble_shows_a_cosine_and_a_sine_of_twice_the_angle() {
        let mut alone = OneEffect::new(&CrossAxis::default());
        for (angle_deg, worked_ug) in [(0.0, 100.0), (45.0, 70.710_678 + 10.0), (90.0, 0.0), (180.0, -100.0)] {
            alone.apply(angle_deg);
            assert!((alone.look().bias_ug - worked_ug).abs() < 1e-5, "{angle_deg}°");
        }
    }
}
