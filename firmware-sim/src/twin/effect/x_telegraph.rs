//! `x-telegraph`: the bias jumps between two values at random times.
//!
//! ```text
//! B ∈ {−h/2, +h/2},   jumps at the rate 1/τ in both directions
//! ```
//!
//! Acts as an acceleration; nothing that is recorded foretells it. Typical: 5–100 µg, 10–10⁴ s; popcorn noise, an
//! engineering estimate.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `x-telegraph`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Telegraph {
    /// h: height of a jump, µg.
    pub step_ug: f64,
    /// τ: mean time between jumps, s.
    pub dwell_s: f64,
}

impl Default for Telegraph {
    fn default() -> Self {
        Self { step_ug: 20.0, dwell_s: 600.0 }
    }
}

impl Switch for Telegraph {
    const NAME: &'static str = "x-telegraph";

    fn check(&self) -> Result<(), Fault> {
        within("step_ug", self.step_ug, -1e5, 1e5)?;
        positive("dwell_s", self.dwell_s)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { step_ug: self.step_ug * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { dwell_s: random.log_between(60.0, 3600.0), ..self.clone() }
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(Jumping { of: self.clone(), random: setting.random(Self::NAME), level: 0.5 })
    }
}

struct Jumping {
    of: Telegraph,
    random: Random,
    level: f64,
}

impl Effect for Jumping {
    fn advance(&mut self, _now: &Conditions, dt_s: f64) {
        // The chance of an odd number of jumps, exact for any step.
        let chance = -0.5 * (-2.0 * dt_s / self.of.dwell_s).exp_m1();
        if self.random.uniform() < chance {
            self.level = -self.level;
        }
    }

    fn act(&self, _now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.of.step_ug * 1e-6 * self.level;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn it_has_two_values_and_jumps_every_ten_minutes() {
        let mut alone = OneEffect::new(&Telegraph::default());
        let (mut jumps, mut before_ug) = (0, alone.look().bias_ug);
        for _ in 0..120_000 {
            alone.pass(1.0);
            let now_ug = alone.look().bias_ug;
            assert!((now_ug.abs() - 10.0).abs() < 1e-6);
            jumps += i32::from((now_ug - before_ug).abs() > 1.0);
            before_ug = now_ug;
        }
        assert!((160..=240).contains(&jumps), "{jumps}"); // 200 ± 14, three standard deviations
    }
}
