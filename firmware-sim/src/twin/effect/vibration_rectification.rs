//! `vibration-rectification`: vibration shifts the bias.
//!
//! ```text
//! ΔB = K_VR·g_rms²
//! ```
//!
//! Acts as an acceleration. Typical: 10–100 µg/g² for navigation-grade vibrating beams. IEEE Std 1293, vibration
//! rectification; US 8,117,917; US 12,000,858.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `vibration-rectification`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VibrationRectification {
    /// K_VR, µg/g².
    pub ug_per_g2: f64,
}

impl Default for VibrationRectification {
    fn default() -> Self {
        Self { ug_per_g2: 20.0 }
    }
}

impl Switch for VibrationRectification {
    const NAME: &'static str = "vibration-rectification";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_g2", self.ug_per_g2, -1e5, 1e5)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_g2: self.ug_per_g2 * factor }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Shaken(self.clone()))
    }
}

struct Shaken(VibrationRectification);

impl Effect for Shaken {
    fn act(&self, now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.0.ug_per_g2 * 1e-6 * now.vibration_g2;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn two_g_rms_are_80_micro_g() {
        let mut alone = OneEffect::new(&VibrationRectification::default());
        alone.now.vibration_g2 = 4.0;
        assert!((alone.look().bias_ug - 80.0).abs() < 1e-4);
    }
}
