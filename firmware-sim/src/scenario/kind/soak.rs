//! `soak`: the chamber is sent somewhere, and the device records for days what follows.

use serde::{Deserialize, Serialize};

use crate::limit::{CHAMBER_C, Fault, LONGEST_S, each_within, up_to, within};
use crate::scenario::programme::Programme;
use crate::twin::position::Position;
use crate::twin::random::Random;

/// From room temperature to one temperature after another, recorded all the time: what creeps shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Soak {
    /// Temperatures in the order in which the chamber is sent there, °C.
    pub temperatures_c: Vec<f64>,
    /// Time at every temperature, recorded, s.
    pub dwell_s: f64,
    /// The pose; the input axis sees the sine, degrees.
    pub position_deg: f64,
}

impl Default for Soak {
    fn default() -> Self {
        Self { temperatures_c: vec![60.0, 25.0], dwell_s: 259_200.0, position_deg: 0.0 }
    }
}

impl Soak {
    pub(super) fn check(&self) -> Result<(), Fault> {
        each_within("temperatures_c", &self.temperatures_c, CHAMBER_C.0, CHAMBER_C.1)?;
        up_to("dwell_s", self.dwell_s, LONGEST_S)?;
        within("position_deg", self.position_deg, -360.0, 360.0)
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        programme.turn_to(Position::tumble(self.position_deg));
        for temperature_c in &self.temperatures_c {
            programme.step_to(*temperature_c).record(self.dwell_s);
        }
    }
}
