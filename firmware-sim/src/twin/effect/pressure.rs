//! `pressure`: the air bends the package's lid.
//!
//! ```text
//! ΔB = K_p·(p − p0)
//! ```
//!
//! Stress of the package: both forks shift together, and their mismatch shows as bias. Typical: 0.1–1 µg/hPa for
//! ceramic packages, ten times that for thin caps; an engineering estimate.

use serde::{Deserialize, Serialize};

use super::{Effect, STRESS_MISMATCH, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::random::Random;

/// Parameters of `pressure`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Pressure {
    /// K_p, µg/hPa.
    pub ug_per_hpa: f64,
}

impl Default for Pressure {
    fn default() -> Self {
        Self { ug_per_hpa: 0.3 }
    }
}

impl Switch for Pressure {
    const NAME: &'static str = "pressure";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_hpa", self.ug_per_hpa, -1e4, 1e4)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_hpa: self.ug_per_hpa * factor }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let ambient_pa = setting.rig.pressure_pa;
        Box::new(Pressed { of: self.clone(), ambient_pa, hz_per_ug: setting.hz_per_ug() })
    }
}

struct Pressed {
    of: Pressure,
    /// p0: the pressure in which the device is at home, Pa.
    ambient_pa: f64,
    hz_per_ug: f64,
}

impl Effect for Pressed {
    fn pull(&self, now: &Conditions, forks: &mut Forks) {
        let bias_ug = self.of.ug_per_hpa * (now.pressure_pa - self.ambient_pa) / 100.0;
        forks.shift_common(bias_ug * self.hz_per_ug, STRESS_MISMATCH);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn half_an_atmosphere_less_is_150_micro_g_less() {
        let mut alone = OneEffect::new(&Pressure::default());
        alone.now.pressure_pa -= 50_000.0;
        assert!((alone.look().bias_ug + 150.0).abs() < 1e-3);
    }
}
