//! `second-order`: the sensing element itself is not linear, on top of what the forks' mismatch makes.
//!
//! ```text
//! ΔB = K2·a²
//! ```
//!
//! Acts as an acceleration. Typical: 1–50 µg/g². IEEE Std 1293, K2; Qiu et al., bulk-micromachined silicon resonant
//! accelerometer.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `second-order`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SecondOrder {
    /// K2, µg/g².
    pub ug_per_g2: f64,
}

impl Default for SecondOrder {
    fn default() -> Self {
        Self { ug_per_g2: 10.0 }
    }
}

impl Switch for SecondOrder {
    const NAME: &'static str = "second-order";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_g2", self.ug_per_g2, -1e4, 1e4)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_g2: self.ug_per_g2 * factor }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Bent(self.clone()))
    }
}

struct Bent(SecondOrder);

impl Effect for Bent {
    fn act(&self, now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.0.ug_per_g2 * 1e-6 * now.applied_g.powi(2);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn both_ends_read_high_and_the_middle_right() {
        let mut alone = OneEffect::new(&SecondOrder::default());
        for (angle_deg, worked_ug) in [(0.0, 0.0), (30.0, 2.5), (90.0, 10.0), (270.0, 10.0)] {
            alone.apply(angle_deg);
            assert!((alone.look().bias_ug - worked_ug).abs() < 1e-6, "{angle_deg}°");
        }
    }
}
