//! `humidity`: the air gets damp and dry again.

use serde::{Deserialize, Serialize};

use super::{Places, Sweep};
use crate::scenario::limit::{Fault, each_within};
use crate::scenario::programme::Programme;
use crate::twin::random::Random;

/// Climate chamber: the humidity goes from value to value and stays long, as moisture takes its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Humidity {
    /// Relative humidities, percent.
    pub humidities_pct: Vec<f64>,
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

impl Default for Humidity {
    fn default() -> Self {
        Self {
            humidities_pct: vec![40.0, 85.0, 40.0],
            temperatures_c: vec![25.0],
            soak_s: 3600.0,
            positions_deg: vec![0.0],
            settle_s: 0.0,
            dwell_s: 172_800.0,
        }
    }
}

impl Humidity {
    pub(super) fn check(&self) -> Result<(), Fault> {
        each_within("humidities_pct", &self.humidities_pct, 0.0, 100.0)?;
        self.places().check()
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        let set = |now: &mut super::Segment, humidity_pct: f64| now.humidity_pct = humidity_pct;
        self.places().sweep(programme, &Sweep { values: &self.humidities_pct, set: &set });
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
