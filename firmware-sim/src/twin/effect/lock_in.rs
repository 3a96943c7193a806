//! `lock-in`: the forks pull each other's frequency when they come close.
//!
//! ```text
//! Δf_seen = 0 for |Δf| < f_L,   else sgn(Δf)·√(Δf² − f_L²)
//! ```
//!
//! Adler's equation of injection locking, averaged over the beat. The pull is mutual: the mean stays. Within ±1.2 g the
//! nominal device crosses Δf = 0 near −0.91 g. Typical: f_L 0.01–10 Hz. Zhao et al., JMEMS 2019,
//! 10.1109/JMEMS.2019.2908931; US 10,168,194; Xu et al., Microsystems & Nanoengineering (synchronisation range).

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::random::Random;

/// Parameters of `lock-in`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LockIn {
    /// f_L: difference below which the forks run as one, Hz.
    pub range_hz: f64,
}

impl Default for LockIn {
    fn default() -> Self {
        Self { range_hz: 2.0 }
    }
}

impl Switch for LockIn {
    const NAME: &'static str = "lock-in";

    fn check(&self) -> Result<(), Fault> {
        within("range_hz", self.range_hz, 0.0, 1e3)
    }

    /// Away from the locked zone the pull is `f_L²/2Δf`: the influence grows with the square.
    fn scaled(&self, factor: f64) -> Self {
        Self { range_hz: self.range_hz * factor.abs().sqrt() }
    }

    fn varied(&self, _random: &mut Random) -> Self {
        self.clone()
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Locking(self.clone()))
    }
}

struct Locking(LockIn);

impl Effect for Locking {
    fn pull(&self, _now: &Conditions, forks: &mut Forks) {
        let delta_hz = forks.delta_hz();
        let beat_hz2 = delta_hz * delta_hz - self.0.range_hz * self.0.range_hz;
        let seen_hz = beat_hz2.max(0.0).sqrt().copysign(delta_hz);
        forks.shift_apart(seen_hz - delta_hz);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn at_76_hz_the_pull_is_the_worked_26_millihertz() {
        let seen = OneEffect::new(&LockIn::default()).look();
        assert!((seen.bias_ug + 0.315e3).abs() < 1.0 && seen.mean_hz.abs() < 1e-9, "{seen:?}");
    }

    #[test]
    fn near_zero_difference_the_forks_run_as_one() {
        let mut forks = Forks { f1_hz: 41_200.5, f2_hz: 41_199.0 };
        let alone = OneEffect::new(&LockIn::default());
        alone.effect.pull(&alone.now, &mut forks);
        assert!(forks.delta_hz().abs() < 1e-9 && (forks.f1_hz - 41_199.75).abs() < 1e-9);
    }
}
