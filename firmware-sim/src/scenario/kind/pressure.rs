//! `pressure`: the air is pumped off and let in.

use serde::{Deserialize, Serialize};

use super::{Places, Sweep};
use crate::scenario::limit::{Fault, each_within};
use crate::scenario::programme::Programme;
use crate::twin::random::Random;

/// Bell jar: the pressure goes from value to value, in every pose, at every temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Pressure {
    /// Pressures, Pa.
    pub pressures_pa: Vec<f64>,
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

impl Default for Pressure {
    fn default() -> Self {
        Self {
            pressures_pa: vec![101_325.0, 90_000.0, 70_000.0, 50_000.0, 70_000.0, 101_325.0],
            temperatures_c: vec![25.0],
            soak_s: 3600.0,
            positions_deg: vec![0.0],
            settle_s: 60.0,
            dwell_s: 120.0,
        }
    }
}

impl Pressure {
    pub(super) fn check(&self) -> Result<(), Fault> {
        each_within("pressures_pa", &self.pressures_pa, 0.0, 1e6)?;
        self.places().check()
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        let set = |now: &mut super::Segment, pressure_pa: f64| now.pressure_pa = pressure_pa;
        self.places().sweep(programme, &Sweep { values: &self.pressures_pa, set: &set });
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
