//! `g-hysteresis`: the flexure remembers the acceleration before.
//!
//! ```text
//! τ·dz/dt = a − z        ΔB = K·(z − a)
//! ```
//!
//! Acts as an acceleration. In a fixed order of positions it looks like misalignment; a random order tells them
//! apart. Typical: 1–50 µg after ±1 g, 10–1000 s. IEEE Std 1293, hysteresis and threshold; the sizes are engineering
//! estimates.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::lag::relax;
use crate::twin::random::Random;

/// Parameters of `g-hysteresis`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GHysteresis {
    /// K: bias right after a change by 1 g, µg/g.
    pub ug_per_g: f64,
    /// τ: time constant of forgetting, s.
    pub tau_s: f64,
}

impl Default for GHysteresis {
    fn default() -> Self {
        Self { ug_per_g: 20.0, tau_s: 200.0 }
    }
}

impl Switch for GHysteresis {
    const NAME: &'static str = "g-hysteresis";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_g", self.ug_per_g, -1e5, 1e5)?;
        positive("tau_s", self.tau_s)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_g: self.ug_per_g * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { tau_s: random.log_between(20.0, 1000.0), ..self.scaled(random.sign()) }
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Remembering { of: self.clone(), remembered_g: 0.0 })
    }
}

struct Remembering {
    of: GHysteresis,
    remembered_g: f64,
}

impl Effect for Remembering {
    fn advance(&mut self, now: &Conditions, dt_s: f64) {
        self.remembered_g = relax(self.remembered_g, now.applied_g, dt_s, self.of.tau_s);
    }

    fn act(&self, now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.of.ug_per_g * 1e-6 * (self.remembered_g - now.applied_g);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn after_1_g_the_level_reads_high_and_forgets_in_200_s() {
        let mut alone = OneEffect::new(&GHysteresis::default());
        alone.apply(90.0);
        alone.pass(5000.0);
        alone.apply(0.0);
        assert!((alone.look().bias_ug - 20.0).abs() < 1e-3);
        alone.pass(200.0);
        assert!((alone.look().bias_ug - 20.0 / std::f64::consts::E).abs() < 1e-3);
    }
}
