//! `humidity`: moisture swells package or board.
//!
//! ```text
//! τ·dh/dt = RH − h        ΔB = K_h·(h − h0)
//! ```
//!
//! Stress of the package: both forks shift together, and their mismatch shows as bias. Typical: nothing for hermetic
//! parts, 1–100 µg/%RH and 5–50 h for plastic ones. JMEMS 2021-0212.

use serde::{Deserialize, Serialize};

use super::{Effect, STRESS_MISMATCH, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::lag::relax;
use crate::twin::random::Random;

/// Parameters of `humidity`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Humidity {
    /// K_h, µg per percent of relative humidity.
    pub ug_per_pct: f64,
    /// τ: time constant of the moisture in the material, h.
    pub tau_h: f64,
}

impl Default for Humidity {
    fn default() -> Self {
        Self { ug_per_pct: 5.0, tau_h: 20.0 }
    }
}

impl Switch for Humidity {
    const NAME: &'static str = "humidity";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_pct", self.ug_per_pct, -1e4, 1e4)?;
        positive("tau_h", self.tau_h)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_pct: self.ug_per_pct * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { tau_h: random.log_between(5.0, 50.0), ..self.scaled(random.sign()) }
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let home_pct = setting.rig.humidity_pct;
        Box::new(Swelling { of: self.clone(), home_pct, moisture_pct: home_pct, hz_per_ug: setting.hz_per_ug() })
    }
}

struct Swelling {
    of: Humidity,
    /// h0: the humidity in which the device was built, percent.
    home_pct: f64,
    moisture_pct: f64,
    hz_per_ug: f64,
}

impl Effect for Swelling {
    fn advance(&mut self, now: &Conditions, dt_s: f64) {
        self.moisture_pct = relax(self.moisture_pct, now.humidity_pct, dt_s, self.of.tau_h * 3600.0);
    }

    fn pull(&self, _now: &Conditions, forks: &mut Forks) {
        let bias_ug = self.of.ug_per_pct * (self.moisture_pct - self.home_pct);
        forks.shift_common(bias_ug * self.hz_per_ug, STRESS_MISMATCH);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn from_40_to_85_percent_the_bias_swells_in_20_hours() {
        let mut alone = OneEffect::new(&Humidity::default());
        alone.now.humidity_pct = 85.0;
        assert!(alone.look().bias_ug.abs() < 1e-6);
        alone.pass(72_000.0);
        assert!((alone.look().bias_ug - 225.0 * (1.0 - (-1.0_f64).exp())).abs() < 0.01);
    }
}
