//! `x-tide`: the building leans with the day.
//!
//! ```text
//! a = g·sin(θ + ψ),   ψ = ψ0·sin(2πt/24 h + φ)
//! ```
//!
//! Acts on the applied acceleration: everything at 0 g, nothing at ±1 g. Typical: 1–10 µrad a day; IEEE Std 1293,
//! geophysical effects.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `x-tide`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tide {
    /// ψ0: amplitude of the tilt, µrad.
    pub amplitude_urad: f64,
    /// Period, h.
    pub period_h: f64,
}

impl Default for Tide {
    fn default() -> Self {
        Self { amplitude_urad: 5.0, period_h: 24.0 }
    }
}

impl Switch for Tide {
    const NAME: &'static str = "x-tide";

    fn check(&self) -> Result<(), Fault> {
        within("amplitude_urad", self.amplitude_urad, -1e5, 1e5)?;
        positive("period_h", self.period_h)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { amplitude_urad: self.amplitude_urad * factor, ..self.clone() }
    }

    fn varied(&self, _random: &mut Random) -> Self {
        self.clone()
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(Leaning { of: self.clone(), phase: setting.random(Self::NAME).uniform() })
    }
}

struct Leaning {
    of: Tide,
    /// Of one period, at the moment the device was built.
    phase: f64,
}

impl Effect for Leaning {
    fn act(&self, now: &Conditions, input: &mut Input) {
        let periods = now.age_days * 24.0 / self.of.period_h + self.phase;
        let tilt_rad = self.of.amplitude_urad * 1e-6 * (std::f64::consts::TAU * periods).sin();
        input.acceleration_g += now.position.tilt_g_per_rad * tilt_rad;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn over_a_day_the_level_sways_by_5_micro_g_and_1_g_does_not() {
        let mut alone = OneEffect::new(&Tide::default());
        let mut highest_ug: f64 = 0.0;
        for quarter in 0..96 {
            alone.now.age_days = f64::from(quarter) / 96.0;
            highest_ug = highest_ug.max(alone.look().bias_ug);
        }
        assert!((highest_ug - 5.0).abs() < 0.02, "{highest_ug}");
        alone.apply(90.0);
        assert!(alone.look().bias_ug.abs() < 1e-6);
    }
}
