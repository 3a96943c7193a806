//! `supply`: the supply voltage is swept.

use serde::{Deserialize, Serialize};

use super::{Places, Sweep};
use crate::scenario::limit::{Fault, each_within};
use crate::scenario::programme::Programme;
use crate::twin::random::Random;

/// The supply goes from value to value, in every pose, at every temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Supply {
    /// Deviations from the nominal supply, percent.
    pub offsets_pct: Vec<f64>,
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

impl Default for Supply {
    fn default() -> Self {
        Self {
            offsets_pct: vec![-5.0, -2.5, 0.0, 2.5, 5.0],
            temperatures_c: vec![25.0],
            soak_s: 3600.0,
            positions_deg: vec![0.0, 90.0, 270.0],
            settle_s: 5.0,
            dwell_s: 20.0,
        }
    }
}

impl Supply {
    pub(super) fn check(&self) -> Result<(), Fault> {
        each_within("offsets_pct", &self.offsets_pct, -50.0, 50.0)?;
        self.places().check()
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        let nominal_v = programme.supply_v();
        let set = |now: &mut super::Segment, offset_pct: f64| now.supply_v = nominal_v * (1.0 + offset_pct / 100.0);
        self.places().sweep(programme, &Sweep { values: &self.offsets_pct, set: &set });
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
