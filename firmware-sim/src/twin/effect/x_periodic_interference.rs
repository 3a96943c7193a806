//! `x-periodic-interference`: something else in the laboratory switches on and off.
//!
//! ```text
//! ΔB = A·sin(2πt/P + φ)
//! ```
//!
//! Acts as an acceleration and goes on by the calendar, not by the run; the phase is random. Typical: an air
//! conditioner's period of minutes; an invention for blind tests.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::DAY_S;
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `x-periodic-interference`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PeriodicInterference {
    /// A: amplitude, µg.
    pub amplitude_ug: f64,
    /// P: period, s.
    pub period_s: f64,
}

impl Default for PeriodicInterference {
    fn default() -> Self {
        Self { amplitude_ug: 20.0, period_s: 412.0 }
    }
}

impl Switch for PeriodicInterference {
    const NAME: &'static str = "x-periodic-interference";

    fn check(&self) -> Result<(), Fault> {
        within("amplitude_ug", self.amplitude_ug, -1e5, 1e5)?;
        positive("period_s", self.period_s)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { amplitude_ug: self.amplitude_ug * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { period_s: random.log_between(120.0, 3600.0), ..self.clone() }
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(Swinging { of: self.clone(), phase: setting.random(Self::NAME).uniform() })
    }
}

struct Swinging {
    of: PeriodicInterference,
    /// Of one period, at the moment the device was built.
    phase: f64,
}

impl Effect for Swinging {
    fn act(&self, now: &Conditions, input: &mut Input) {
        let periods = now.age_days * DAY_S / self.of.period_s + self.phase;
        input.acceleration_g += self.of.amplitude_ug * 1e-6 * (std::f64::consts::TAU * periods).sin();
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn half_a_period_later_it_is_the_opposite() {
        let mut alone = OneEffect::new(&PeriodicInterference::default());
        let before_ug = alone.look().bias_ug;
        alone.pass(206.0);
        assert!((alone.look().bias_ug + before_ug).abs() < 1e-6 && before_ug.abs() > 0.1);
    }
}
