//! `x-annealing-step`: the first visit to a temperature leaves a bias behind.
//!
//! ```text
//! ΔB = ρ·(T_max − T_built),   T_max the highest temperature so far
//! ```
//!
//! Acts as an acceleration; it is over once the device has seen its hottest day. Typical: 10–300 µg after the first
//! excursions to 60–85 °C. Peng et al., IEEE Sensors Journal 2023, 10.1109/jsen.2022.3222006; the form is an
//! engineering estimate.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `x-annealing-step`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AnnealingStep {
    /// ρ: bias per kelvin of new highest temperature, µg/K.
    pub ug_per_k: f64,
}

impl Default for AnnealingStep {
    fn default() -> Self {
        Self { ug_per_k: 2.0 }
    }
}

impl Switch for AnnealingStep {
    const NAME: &'static str = "x-annealing-step";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_k", self.ug_per_k, -1e4, 1e4)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_k: self.ug_per_k * factor }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let built_c = setting.rig.room_c;
        Box::new(Annealed { of: self.clone(), built_c, highest_c: built_c })
    }
}

struct Annealed {
    of: AnnealingStep,
    built_c: f64,
    highest_c: f64,
}

impl Effect for Annealed {
    fn advance(&mut self, now: &Conditions, _dt_s: f64) {
        self.highest_c = self.highest_c.max(now.sensor_c);
    }

    fn act(&self, _now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.of.ug_per_k * 1e-6 * (self.highest_c - self.built_c);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn the_first_visit_to_60_c_leaves_70_micro_g_and_the_second_nothing() {
        let mut alone = OneEffect::new(&AnnealingStep::default());
        for _ in 0..2 {
            alone.ramp(35.0, 600.0);
            alone.ramp(-35.0, 600.0);
            assert!((alone.look().bias_ug - 70.0).abs() < 1e-6);
        }
    }
}
