//! `x-magnetic`: a field that nobody records, and a heading that nobody notes.
//!
//! ```text
//! ΔB = K_B·B·cos(heading)
//! ```
//!
//! Acts as an acceleration. The heading is drawn anew for every pose, as when the base of the rig stands on castors.
//! Typical: 0.1–10 µg/mT through a Kovar lid; the drive magnet of a rate table makes 20 mT. IEEE Std 1293, magnetic
//! sensitivity; the sizes are engineering estimates.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::random::Random;

/// Parameters of `x-magnetic`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Magnetic {
    /// K_B: sensitivity, µg/mT.
    pub ug_per_mt: f64,
    /// B: horizontal field, mT.
    pub field_mt: f64,
}

impl Default for Magnetic {
    fn default() -> Self {
        Self { ug_per_mt: 1.0, field_mt: 20.0 }
    }
}

impl Switch for Magnetic {
    const NAME: &'static str = "x-magnetic";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_mt", self.ug_per_mt, -1e4, 1e4)?;
        within("field_mt", self.field_mt, 0.0, 1e3)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_mt: self.ug_per_mt * factor, ..self.clone() }
    }

    fn varied(&self, _random: &mut Random) -> Self {
        self.clone()
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let random = setting.random(Self::NAME);
        Box::new(Turning { of: self.clone(), random, pose: None, alignment: 0.0 })
    }
}

struct Turning {
    of: Magnetic,
    random: Random,
    pose: Option<usize>,
    /// Cosine of the heading.
    alignment: f64,
}

impl Effect for Turning {
    fn begin_run(&mut self) {
        self.pose = None;
    }

    fn advance(&mut self, now: &Conditions, _dt_s: f64) {
        if self.pose != Some(now.pose) {
            self.pose = Some(now.pose);
            self.alignment = (std::f64::consts::TAU * self.random.uniform()).cos();
        }
    }

    fn act(&self, _now: &Conditions, input: &mut Input) {
        input.acceleration_g += self.of.ug_per_mt * self.of.field_mt * 1e-6 * self.alignment;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn it_holds_still_for_a_pose_and_scatters_from_pose_to_pose() {
        let mut alone = OneEffect::new(&Magnetic::default());
        let mut squares = 0.0;
        for pose in 0..2000 {
            alone.now.pose = pose;
            alone.pass(1.0);
            let first_ug = alone.look().bias_ug;
            alone.pass(5.0);
            assert!((alone.look().bias_ug - first_ug).abs() < 1e-9);
            squares += first_ug * first_ug;
        }
        // 20 µg·√½; the cosine's square has a standard deviation of 0.35: four standard errors.
        assert!((f64::sqrt(squares / 2000.0) - 14.14).abs() < 0.5, "{}", f64::sqrt(squares / 2000.0));
    }
}
