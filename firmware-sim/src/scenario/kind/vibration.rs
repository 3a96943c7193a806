//! `vibration`: the shaker runs at one level after another.

use serde::{Deserialize, Serialize};

use super::{Places, Sweep};
use crate::scenario::limit::{Fault, each_within};
use crate::scenario::programme::Programme;
use crate::twin::random::Random;

/// Random vibration along the input axis, in every pose, at every temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Vibration {
    /// Levels, g rms.
    pub levels_g_rms: Vec<f64>,
    /// Temperatures at which all of it is done, °C.
    pub temperatures_c: Vec<f64>,
    /// Time at every temperature before recording, s.
    pub soak_s: f64,
    /// Poses in which all of it is done; the input axis sees the sine, degrees.
    pub positions_deg: Vec<f64>,
    /// Time at every value that is not kept, s.
    pub settle_s: f64,
    /// Time at every value that is recorded, s.
    pub dwell_s: f64,
}

impl Default for Vibration {
    fn default() -> Self {
        Self {
            levels_g_rms: vec![0.0, 2.0, 4.0, 6.0],
            temperatures_c: vec![25.0],
            soak_s: 3600.0,
            positions_deg: vec![0.0, 90.0],
            settle_s: 5.0,
            dwell_s: 30.0,
        }
    }
}

impl Vibration {
    pub(super) fn check(&self) -> Result<(), Fault> {
        each_within("levels_g_rms", &self.levels_g_rms, 0.0, 100.0)?;
        self.places().check()
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        let set = |now: &mut super::Segment, level_g: f64| now.vibration_g2 = level_g * level_g;
        self.places().sweep(programme, &Sweep { values: &self.levels_g_rms, set: &set });
    }

    fn places(&self) -> Places<'_> {
        Places {
            temperatures_c: &self.temperatures_c,
            soak_s: self.soak_s,
            positions_deg: &self.positions_deg,
            settle_s: self.settle_s,
            dwell_s: self.dwell_s,
        }
    }
}
