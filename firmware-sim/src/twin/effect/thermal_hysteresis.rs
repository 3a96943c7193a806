//! `thermal-hysteresis`: the bias depends on the side from which the temperature came, however slowly it came.
//!
//! ```text
//! z follows T with a play of ±r        ΔB = w·(z − T)
//! ```
//!
//! A play operator (Prandtl–Ishlinskii) of the package's stress: both forks shift together, and their mismatch shows
//! as bias. It remembers through power-off. Typical: half-width 20 µg–1 mg over 100 K, play 1–30 K. ADXL354/355 data
//! sheet; "Thermal hysteresis in inertial sensors", 2020.

use serde::{Deserialize, Serialize};

use super::{Effect, STRESS_MISMATCH, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::random::Random;

/// Parameters of `thermal-hysteresis`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ThermalHysteresis {
    /// w: bias per kelvin that the package lags, µg/K.
    pub ug_per_k: f64,
    /// r: half the play, K. The loop's half-width is `w·r`.
    pub play_k: f64,
}

impl Default for ThermalHysteresis {
    fn default() -> Self {
        Self { ug_per_k: 10.0, play_k: 10.0 }
    }
}

impl Switch for ThermalHysteresis {
    const NAME: &'static str = "thermal-hysteresis";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_k", self.ug_per_k, -1e5, 1e5)?;
        within("play_k", self.play_k, 0.0, 200.0)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_k: self.ug_per_k * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { play_k: random.log_between(3.0, 20.0), ..self.scaled(random.sign()) }
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(Playing { of: self.clone(), package_c: setting.rig.room_c, hz_per_ug: setting.hz_per_ug() })
    }
}

struct Playing {
    of: ThermalHysteresis,
    /// z: the temperature to which the package's stress belongs, °C.
    package_c: f64,
    hz_per_ug: f64,
}

impl Effect for Playing {
    fn advance(&mut self, now: &Conditions, _dt_s: f64) {
        self.package_c = self.package_c.clamp(now.sensor_c - self.of.play_k, now.sensor_c + self.of.play_k);
    }

    fn pull(&self, now: &Conditions, forks: &mut Forks) {
        let bias_ug = self.of.ug_per_k * (self.package_c - now.sensor_c);
        forks.shift_common(bias_ug * self.hz_per_ug, STRESS_MISMATCH);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn up_and_down_differ_by_twice_the_half_width_at_any_rate() {
        for seconds in [60.0, 6000.0] {
            let mut alone = OneEffect::new(&ThermalHysteresis::default());
            alone.ramp(35.0, seconds);
            alone.ramp(-20.0, seconds);
            let down_ug = alone.look().bias_ug;
            alone.ramp(-35.0, seconds);
            alone.ramp(35.0, seconds);
            let up_ug = alone.look().bias_ug;
            // The map at 40 °C reads a frequency shift with its own scale factor, 0.09 % above nominal.
            assert!((down_ug - 100.0).abs() < 0.2 && (up_ug + 100.0).abs() < 0.2, "{down_ug} {up_ug}");
        }
    }

    #[test]
    fn a_small_excursion_within_the_play_is_reversible() {
        let mut alone = OneEffect::new(&ThermalHysteresis::default());
        alone.ramp(8.0, 60.0);
        alone.ramp(-8.0, 60.0);
        assert!(alone.look().bias_ug.abs() < 1e-6);
    }
}
