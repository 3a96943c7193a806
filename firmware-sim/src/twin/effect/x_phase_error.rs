//! `x-phase-error`: the loop's phase follows the temperature of the circuit board, which nobody records.
//!
//! ```text
//! δf = f0/(2Q)·tan δφ,   δφ = k·(T_pcb − T0)        T_pcb wanders
//! ```
//!
//! Acts on both oscillators; a fifth of it shows in the difference. Typical: f0/2Q is 1.03 Hz, so 0.1°/K is 21 µg/K
//! in one fork. Zhao et al., JMEMS 2019, 10.1109/JMEMS.2019.2908931.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::random::Random;

/// Parameters of `x-phase-error`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PhaseError {
    /// k: phase of the loop per kelvin of the board, degrees/K.
    pub degrees_per_k: f64,
    /// Wander of the board's temperature, K (1σ).
    pub wander_k: f64,
    /// Correlation time of that wander, s.
    pub wander_tau_s: f64,
}

impl Default for PhaseError {
    fn default() -> Self {
        Self { degrees_per_k: 0.02, wander_k: 3.0, wander_tau_s: 1800.0 }
    }
}

/// How differently the two loops react.
const LOOP_MISMATCH: f64 = 0.2;
/// Beyond this the loop would have stopped, degrees.
const LARGEST_DEGREES: f64 = 80.0;

impl Switch for PhaseError {
    const NAME: &'static str = "x-phase-error";

    fn check(&self) -> Result<(), Fault> {
        within("degrees_per_k", self.degrees_per_k, -10.0, 10.0)?;
        within("wander_k", self.wander_k, 0.0, 50.0)?;
        positive("wander_tau_s", self.wander_tau_s)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { degrees_per_k: (self.degrees_per_k * factor).clamp(-10.0, 10.0), ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { wander_tau_s: random.log_between(300.0, 7200.0), ..self.clone() }
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let mut random = setting.random(Self::NAME);
        let warmer_k = self.wander_k * random.normal();
        let half_width_hz = setting.truth.f1_hz / (2.0 * setting.truth.quality_factor);
        Box::new(Wandering { of: self.clone(), random, warmer_k, half_width_hz })
    }
}

struct Wandering {
    of: PhaseError,
    random: Random,
    /// The board above its mean temperature, K.
    warmer_k: f64,
    half_width_hz: f64,
}

impl Effect for Wandering {
    fn advance(&mut self, _now: &Conditions, dt_s: f64) {
        let kept = (-dt_s / self.of.wander_tau_s).exp();
        self.warmer_k = kept * self.warmer_k + self.of.wander_k * (1.0 - kept * kept).sqrt() * self.random.normal();
    }

    fn pull(&self, _now: &Conditions, forks: &mut Forks) {
        let degrees = (self.of.degrees_per_k * self.warmer_k).clamp(-LARGEST_DEGREES, LARGEST_DEGREES);
        let shift_hz = self.half_width_hz * degrees.to_radians().tan();
        forks.shift_common(shift_hz * LOOP_MISMATCH, LOOP_MISMATCH);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn a_tenth_of_a_degree_is_21_micro_g_in_a_fork_and_a_fifth_in_the_difference() {
        let of = PhaseError { degrees_per_k: 0.1, wander_k: 1.0, wander_tau_s: 1e-3 };
        let mut alone = OneEffect::new(&of);
        let (mut mean, mut bias) = (0.0, 0.0);
        for _ in 0..4000 {
            alone.pass(1.0);
            let seen = alone.look();
            mean += (seen.mean_hz / 83.5e-6).powi(2);
            bias += seen.bias_ug.powi(2);
        }
        // 1σ of 1 K, within four standard errors of 4000 draws.
        assert!((f64::sqrt(mean / 4000.0) / 21.5 - 1.0).abs() < 0.05);
        assert!((f64::sqrt(bias / 4000.0) / 4.31 - 1.0).abs() < 0.05);
    }
}
