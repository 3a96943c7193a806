//! `third-order`: the sensing element is stiffer at both ends, on top of what the forks themselves make.
//!
//! ```text
//! ΔB = K3·a³
//! ```
//!
//! Acts as an acceleration. Typical: 0.5 µg/g³, the `s²/8` of an ideal pair; ±40 g linearity of 137 ppm has been
//! measured. IEEE Std 1293, K3; Zhang et al., energy method for nonlinearity of silicon resonant accelerometers.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `third-order`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ThirdOrder {
    /// K3, µg/g³.
    pub ug_per_g3: f64,
}

impl Default for ThirdOrder {
    fn default() -> Self {
        Self { ug_per_g3: 0.5 }
    }
}

impl Switch for ThirdOrder {
    const NAME: &'static str = "third-order";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_g3", self.ug_per_g3, -1e4, 1e4)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_g3: self.ug_per_g3 * factor }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Bent(self.clone()))
    }
}

struct Bent(ThirdOrder);

impl Effect for Bent {
    fn act(&self, now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.0.ug_per_g3 * 1e-6 * now.applied_g.powi(3);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn the_ends_read_off_in_opposite_directions() {
        let mut alone = OneEffect::new(&ThirdOrder { ug_per_g3: 8.0 });
        for (angle_deg, worked_ug) in [(0.0, 0.0), (30.0, 1.0), (90.0, 8.0), (270.0, -8.0)] {
            alone.apply(angle_deg);
            assert!((alone.look().bias_ug - worked_ug).abs() < 1e-6, "{angle_deg}°");
        }
    }
}
