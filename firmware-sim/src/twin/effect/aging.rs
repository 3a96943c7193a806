//! `aging`: the bias moves with the calendar.
//!
//! ```text
//! ΔB = D·t + A_log·ln(1 + t/t0) + A_exp·(1 − e^(−t/τ))
//! ```
//!
//! Acts as an acceleration, the same at every temperature. The linear law is on by default. Typical:
//! 0.1–3 µg/day; 10–200 µg per e-fold for relaxing adhesives; 0.1–10 mg and 10–200 days for curing and
//! out-gassing. Peng et al., IEEE Sensors Journal 2023, 10.1109/jsen.2022.3222006; IMECE2004-47144.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `aging`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Aging {
    /// D: steady drift, µg/day.
    pub linear_ug_per_day: f64,
    /// A_log: drift that slows down for ever, µg per factor e of age.
    pub log_ug: f64,
    /// t0: age at which that drift begins to slow down, days.
    pub log_onset_days: f64,
    /// A_exp: drift that ends, µg in all.
    pub exponential_ug: f64,
    /// τ: time constant of the drift that ends, days.
    pub exponential_tau_days: f64,
}

impl Default for Aging {
    fn default() -> Self {
        Self {
            linear_ug_per_day: 1.0,
            log_ug: 0.0,
            log_onset_days: 1.0,
            exponential_ug: 0.0,
            exponential_tau_days: 30.0,
        }
    }
}

impl Switch for Aging {
    const NAME: &'static str = "aging";

    fn check(&self) -> Result<(), Fault> {
        within("linear_ug_per_day", self.linear_ug_per_day, -1e4, 1e4)?;
        within("log_ug", self.log_ug, -1e5, 1e5)?;
        positive("log_onset_days", self.log_onset_days)?;
        within("exponential_ug", self.exponential_ug, -1e6, 1e6)?;
        positive("exponential_tau_days", self.exponential_tau_days)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            linear_ug_per_day: self.linear_ug_per_day * factor,
            log_ug: self.log_ug * factor,
            exponential_ug: self.exponential_ug * factor,
            ..self.clone()
        }
    }

    fn varied(&self, random: &mut Random) -> Self {
        let of = self.scaled(random.sign());
        let none = Self { linear_ug_per_day: 0.0, ..of.clone() };
        match random.below(3) {
            0 => of,
            1 => Self { log_ug: 60.0, log_onset_days: random.log_between(0.1, 10.0), ..none },
            _ => Self { exponential_ug: 300.0, exponential_tau_days: random.log_between(10.0, 200.0), ..none },
        }
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Aged(self.clone()))
    }
}

struct Aged(Aging);

impl Effect for Aged {
    fn act(&self, now: &Conditions, input: &mut Input) {
        let Self(of) = self;
        let slowing = of.log_ug * (now.age_days / of.log_onset_days).ln_1p();
        let ending = -of.exponential_ug * (-now.age_days / of.exponential_tau_days).exp_m1();
        input.acceleration_g += (of.linear_ug_per_day * now.age_days + slowing + ending) * 1e-6;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn the_three_laws_give_the_worked_values_after_30_days() {
        let off = Aging { linear_ug_per_day: 0.0, ..Aging::default() };
        for (law, worked_ug) in [
            (Aging::default(), 30.0),
            (Aging { log_ug: 60.0, ..off.clone() }, 60.0 * 31.0_f64.ln()),
            (Aging { exponential_ug: 300.0, ..off }, 300.0 * (1.0 - (-1.0_f64).exp())),
        ] {
            let mut alone = OneEffect::new(&law);
            alone.now.age_days = 30.0;
            let seen = alone.look();
            assert!((seen.bias_ug - worked_ug).abs() < 1e-3, "{law:?}: {seen:?}");
        }
    }
}
