//! `power-cycle`: at every temperature the power goes off, for long and for short, and comes back.

use serde::{Deserialize, Serialize};

use crate::limit::{CHAMBER_C, Fault, LONGEST_S, each_within, up_to, within};
use crate::scenario::programme::Programme;
use crate::twin::position::Position;
use crate::twin::random::Random;

/// What settles after power-on shows; a short power-off tells heat, which stays, from electronics, which begins anew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PowerCycle {
    /// Temperatures in the order in which the chamber is sent there, °C.
    pub temperatures_c: Vec<f64>,
    /// Time at every temperature before the first power-off, s.
    pub soak_s: f64,
    /// How long the power stays off, one cycle each, s.
    pub off_s: Vec<f64>,
    /// Recorded time after every power-on, s.
    pub on_s: f64,
    /// The pose; the input axis sees the sine, degrees.
    pub position_deg: f64,
}

impl Default for PowerCycle {
    fn default() -> Self {
        Self {
            temperatures_c: vec![-20.0, 25.0, 55.0],
            soak_s: 3600.0,
            off_s: vec![7200.0, 300.0],
            on_s: 2700.0,
            position_deg: 0.0,
        }
    }
}

impl PowerCycle {
    pub(super) fn check(&self) -> Result<(), Fault> {
        each_within("temperatures_c", &self.temperatures_c, CHAMBER_C.0, CHAMBER_C.1)?;
        within("soak_s", self.soak_s, 0.0, LONGEST_S)?;
        each_within("off_s", &self.off_s, 1.0, LONGEST_S)?;
        up_to("on_s", self.on_s, LONGEST_S)?;
        within("position_deg", self.position_deg, -360.0, 360.0)
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        programme.turn_to(Position::tumble(self.position_deg));
        for temperature_c in &self.temperatures_c {
            programme.send_to(*temperature_c).wait(self.soak_s);
            for off_s in &self.off_s {
                programme.set(|now| now.powered = false).wait(*off_s);
                programme.set(|now| now.powered = true).record(self.on_s);
            }
        }
    }
}
