//! `turn-on`: every power-on has a bias of its own.
//!
//! ```text
//! B_run ~ N(0, σ²)
//! ```
//!
//! Acts as an acceleration, constant within a run. Typical: 50–500 µg; 150 µg for the laboratory of Micromachines 2022,
//! 13(7), 1054; Safran MS1000 data sheet, long-term bias repeatability.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `turn-on`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TurnOn {
    /// σ: scatter of the bias from run to run, µg.
    pub sigma_ug: f64,
}

impl Default for TurnOn {
    fn default() -> Self {
        Self { sigma_ug: 150.0 }
    }
}

impl Switch for TurnOn {
    const NAME: &'static str = "turn-on";

    fn check(&self) -> Result<(), Fault> {
        within("sigma_ug", self.sigma_ug, 0.0, 1e6)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { sigma_ug: self.sigma_ug * factor }
    }

    fn varied(&self, _random: &mut Random) -> Self {
        self.clone()
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(TurnedOn { sigma_ug: self.sigma_ug, random: setting.random(Self::NAME), bias_ug: 0.0 })
    }
}

struct TurnedOn {
    sigma_ug: f64,
    random: Random,
    bias_ug: f64,
}

impl Effect for TurnedOn {
    fn begin_run(&mut self) {
        self.bias_ug = self.sigma_ug * self.random.normal();
    }

    fn act(&self, _now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.bias_ug * 1e-6;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn every_run_has_its_own_constant() {
        let mut alone = OneEffect::new(&TurnOn::default());
        let runs: Vec<f64> = (0..2000)
            .map(|_| {
                alone.effect.begin_run();
                alone.look().bias_ug
            })
            .collect();
        let rms = (runs.iter().map(|x| x * x).sum::<f64>() / 2000.0).sqrt();
        assert!((rms / 150.0 - 1.0).abs() < 0.065, "{rms}"); // four standard errors
    }
}
