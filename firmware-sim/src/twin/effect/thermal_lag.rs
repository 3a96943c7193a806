//! `thermal-lag`: the forks take their temperature later than the thermometer.
//!
//! ```text
//! T_r = (1 − w)·L_τ1[T_s] + w·L_τ2[T_s]        τ·dL/dt = T_s − L
//! ```
//!
//! Acts on the temperature of both forks, so the sum of the frequencies shows it. Typical: 35 s for a thermometer on
//! the package, up to 900 s for one on the board; the second branch, off by default, is the fixture behind an
//! incomplete soak. Wang et al., IEEE Sensors Journal 2018, 10.1109/JSEN.2018.2852647; Guo et al., Micromachines 14,
//! 161.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::lag::follow;
use crate::twin::random::Random;

/// Parameters of `thermal-lag`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ThermalLag {
    /// τ1: time constant of the forks behind the thermometer, s.
    pub tau_s: f64,
    /// w: share of the slow branch.
    pub slow_share: f64,
    /// τ2: time constant of the slow branch, s.
    pub slow_tau_s: f64,
}

impl Default for ThermalLag {
    fn default() -> Self {
        Self { tau_s: 35.0, slow_share: 0.0, slow_tau_s: 600.0 }
    }
}

impl Switch for ThermalLag {
    const NAME: &'static str = "thermal-lag";

    fn check(&self) -> Result<(), Fault> {
        within("tau_s", self.tau_s, 0.01, 5e3)?;
        within("slow_share", self.slow_share, 0.0, 1.0)?;
        within("slow_tau_s", self.slow_tau_s, 0.01, 1e5)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { tau_s: (self.tau_s * factor).clamp(0.01, 5e3), ..self.clone() }
    }

    fn varied(&self, _random: &mut Random) -> Self {
        self.clone()
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(Lagging { of: self.clone(), fast_c: setting.rig.room_c, slow_c: setting.rig.room_c })
    }
}

struct Lagging {
    of: ThermalLag,
    fast_c: f64,
    slow_c: f64,
}

impl Effect for Lagging {
    fn advance(&mut self, now: &Conditions, dt_s: f64) {
        self.fast_c = follow(self.fast_c, now.sensor_before_c, now.sensor_c, dt_s, self.of.tau_s);
        self.slow_c = follow(self.slow_c, now.sensor_before_c, now.sensor_c, dt_s, self.of.slow_tau_s);
    }

    fn act(&self, now: &Conditions, input: &mut Input) {
        let forks_c = self.fast_c + self.of.slow_share * (self.slow_c - self.fast_c);
        input.temperature_c += forks_c - now.sensor_c;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn behind_one_kelvin_a_minute_the_reading_is_off_by_half_a_milli_g() {
        let mut alone = OneEffect::new(&ThermalLag::default());
        alone.ramp(10.0, 600.0);
        let seen = alone.look();
        // −B_T·τ·dT/dt, with 0.901 mg/K at the 35 °C reached; the mean frequency by 2.4 Hz/K.
        assert!((seen.bias_ug + 0.901e3 * 35.0 / 60.0).abs() < 5.0, "{seen:?}");
        assert!((seen.mean_hz - 2.425 * 35.0 / 60.0).abs() < 0.01, "{seen:?}");
    }

    #[test]
    fn a_slow_branch_is_left_behind_after_the_soak() {
        let slow = ThermalLag { slow_share: 0.1, slow_tau_s: 600.0, ..ThermalLag::default() };
        let mut alone = OneEffect::new(&slow);
        alone.ramp(20.0, 1.0);
        alone.pass(1200.0);
        let behind_k = 0.1 * 20.0 * (-2.0_f64).exp();
        assert!((alone.look().bias_ug / (-0.9e3 * behind_k) - 1.0).abs() < 0.02, "{:?}", alone.look());
    }
}
