//! `scale-factor-aging`: the scale factor moves with the calendar.
//!
//! ```text
//! ΔK1/K1 = D_K·t
//! ```
//!
//! Acts on the force sensitivity of both forks. Typical: 0.1–5 ppm/day for parts mounted with epoxy, 10 ppb a month for
//! sealed silicon. Peng et al., IEEE Sensors Journal 2023, 10.1109/jsen.2022.3222006.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `scale-factor-aging`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScaleFactorAging {
    /// D_K: drift of the scale factor, ppm/day.
    pub ppm_per_day: f64,
}

impl Default for ScaleFactorAging {
    fn default() -> Self {
        Self { ppm_per_day: 1.0 }
    }
}

impl Switch for ScaleFactorAging {
    const NAME: &'static str = "scale-factor-aging";

    fn check(&self) -> Result<(), Fault> {
        within("ppm_per_day", self.ppm_per_day, -1e4, 1e4)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ppm_per_day: self.ppm_per_day * factor }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Aged(self.clone()))
    }
}

struct Aged(ScaleFactorAging);

impl Effect for Aged {
    fn act(&self, now: &Conditions, input: &mut Input) {
        input.scale += self.0.ppm_per_day * 1e-6 * now.age_days;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn after_100_days_1_g_reads_100_micro_g_more_and_0_g_the_same() {
        let mut alone = OneEffect::new(&ScaleFactorAging::default());
        alone.now.age_days = 100.0;
        assert!(alone.look().bias_ug.abs() < 1e-6);
        alone.apply(90.0);
        assert!((alone.look().bias_ug - 100.0).abs() < 1e-3);
    }
}
