//! `reference-clock`: the counter's clock is not as fast as it says.
//!
//! ```text
//! f_seen = f·(1 − y)        y = y0 + y_run + D·t
//! ```
//!
//! Both frequencies are off by the same fraction: 41 mHz per ppm in each fork, but only 0.9 µg in the bias and 1 ppm
//! in the scale factor. A constant y0 is part of any calibration; what shows is its change: ageing, and a retrace
//! drawn with every power-on, off by default. Typical: 0.5–2.5 ppm for a compensated crystal, ±20 ppm for a plain one,
//! 1 ppm a year.
//! Crystal oscillator data sheets; IEEE Std 1293, scale-factor error.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::random::Random;

/// Parameters of `reference-clock`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReferenceClock {
    /// y0: how much faster than stated the clock always runs, ppm.
    pub offset_ppm: f64,
    /// Scatter of y_run from power-on to power-on, ppm (1σ).
    pub retrace_ppm: f64,
    /// D: ageing, ppm/day.
    pub ppm_per_day: f64,
}

impl Default for ReferenceClock {
    fn default() -> Self {
        Self { offset_ppm: 0.0, retrace_ppm: 0.0, ppm_per_day: 0.003 }
    }
}

impl Switch for ReferenceClock {
    const NAME: &'static str = "reference-clock";

    fn check(&self) -> Result<(), Fault> {
        within("offset_ppm", self.offset_ppm, -1e3, 1e3)?;
        within("retrace_ppm", self.retrace_ppm, 0.0, 1e3)?;
        within("ppm_per_day", self.ppm_per_day, -100.0, 100.0)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            offset_ppm: self.offset_ppm * factor,
            retrace_ppm: self.retrace_ppm * factor,
            ppm_per_day: self.ppm_per_day * factor,
        }
    }

    fn varied(&self, _random: &mut Random) -> Self {
        self.clone()
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        Box::new(Ticking { of: self.clone(), random: setting.random(Self::NAME), run_ppm: 0.0 })
    }
}

struct Ticking {
    of: ReferenceClock,
    random: Random,
    run_ppm: f64,
}

impl Effect for Ticking {
    fn begin_run(&mut self) {
        self.run_ppm = self.of.retrace_ppm * self.random.normal();
    }

    fn pull(&self, now: &Conditions, forks: &mut Forks) {
        let fast_ppm = self.of.offset_ppm + self.run_ppm + self.of.ppm_per_day * now.age_days;
        forks.f1_hz *= 1.0 - fast_ppm * 1e-6;
        forks.f2_hz *= 1.0 - fast_ppm * 1e-6;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn one_ppm_is_41_millihertz_in_the_mean_and_below_a_micro_g_in_the_bias() {
        let of = ReferenceClock { offset_ppm: 1.0, retrace_ppm: 0.0, ppm_per_day: 0.0 };
        let seen = OneEffect::new(&of).look();
        assert!((seen.mean_hz + 0.0412).abs() < 1e-6 && (seen.bias_ug + 0.910).abs() < 0.001, "{seen:?}");
    }
}
