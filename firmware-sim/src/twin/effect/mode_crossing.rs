//! `mode-crossing`: at one frequency the first fork meets another mode of the structure.
//!
//! ```text
//! ΔB = A·2ξ/(1 + ξ²),   ξ = (f_x − f1)/(w·|df/dT|)
//! ```
//!
//! `f_x` is the fork's frequency at 0 g and the temperature `T_x`. Temperature moves the fork by 2.4 Hz/K and
//! acceleration by 42 Hz/g, so under load the feature appears elsewhere: 17 K per g. Only the first fork is pulled.
//! Typical: 0.05–5 mg, 0.2–5 K; the shape is that of coupled modes (activity dips of quartz), the sizes are
//! engineering estimates.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::random::Random;

/// Parameters of `mode-crossing`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModeCrossing {
    /// A: bias at the two extremes beside the crossing, µg.
    pub amplitude_ug: f64,
    /// w: distance of the extremes from the crossing, K.
    pub width_k: f64,
    /// T_x: temperature of the crossing at 0 g, °C.
    pub temperature_c: f64,
}

impl Default for ModeCrossing {
    fn default() -> Self {
        Self { amplitude_ug: 300.0, width_k: 2.0, temperature_c: 30.0 }
    }
}

impl Switch for ModeCrossing {
    const NAME: &'static str = "mode-crossing";

    fn check(&self) -> Result<(), Fault> {
        within("amplitude_ug", self.amplitude_ug, -1e6, 1e6)?;
        positive("width_k", self.width_k)?;
        within("temperature_c", self.temperature_c, -80.0, 180.0)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { amplitude_ug: self.amplitude_ug * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self {
            temperature_c: -30.0 + 80.0 * random.uniform(),
            width_k: random.log_between(0.5, 5.0),
            ..self.scaled(random.sign())
        }
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let [crossing_hz, _] = setting.map.forks_hz(0.0, self.temperature_c);
        Box::new(Crossing {
            crossing_hz,
            half_width_hz: self.width_k * setting.map.mean_slope_hz_per_c(self.temperature_c).abs(),
            amplitude_hz: self.amplitude_ug * setting.hz_per_ug(),
        })
    }
}

struct Crossing {
    crossing_hz: f64,
    half_width_hz: f64,
    amplitude_hz: f64,
}

impl Effect for Crossing {
    fn pull(&self, _now: &Conditions, forks: &mut Forks) {
        let away = (self.crossing_hz - forks.f1_hz) / self.half_width_hz;
        forks.f1_hz += self.amplitude_hz * 2.0 * away / (1.0 + away * away);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn the_extremes_are_one_width_beside_the_crossing() {
        for (temperature_c, worked_ug) in [(28.0, -300.0), (30.0, 0.0), (32.0, 300.0)] {
            let mut alone = OneEffect::new(&ModeCrossing::default());
            alone.ramp(temperature_c - 25.0, 60.0);
            // The first fork's slope is 1.7 % below the mean slope that defines the width.
            assert!((alone.look().bias_ug - worked_ug).abs() < 0.3, "{temperature_c} °C: {:?}", alone.look());
        }
    }

    #[test]
    fn one_g_moves_the_crossing_by_17_k() {
        let mut alone = OneEffect::new(&ModeCrossing::default());
        alone.apply(90.0);
        let slope = |at_c: f64, alone: &mut OneEffect| {
            alone.now.sensor_c = at_c;
            alone.look().bias_ug
        };
        assert!(slope(46.0, &mut alone) < -100.0 && slope(49.0, &mut alone) > 100.0);
    }
}
