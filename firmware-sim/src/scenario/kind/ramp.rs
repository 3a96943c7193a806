//! `ramp`: the chamber goes up and down at stated rates while the device records.

use serde::{Deserialize, Serialize};

use crate::limit::{CHAMBER_C, Fault, LONGEST_S, each_within, within};
use crate::scenario::programme::Programme;
use crate::twin::position::Position;
use crate::twin::random::Random;

/// For every rate: from one temperature to the other, a hold, back, a hold. Two rates tell a lag from a gradient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ramp {
    /// Where every ramp begins and returns to, °C.
    pub from_c: f64,
    /// Where every ramp turns, °C.
    pub to_c: f64,
    /// The rates, one up-and-down each, K/min.
    pub rates_k_per_min: Vec<f64>,
    /// Time at the first temperature before recording, s.
    pub soak_s: f64,
    /// Recorded time at every turn, in which the chamber catches up, s.
    pub hold_s: f64,
    /// The pose; the input axis sees the sine, degrees.
    pub position_deg: f64,
}

impl Default for Ramp {
    fn default() -> Self {
        Self {
            from_c: -40.0,
            to_c: 60.0,
            rates_k_per_min: vec![1.0],
            soak_s: 7200.0,
            hold_s: 3600.0,
            position_deg: 0.0,
        }
    }
}

impl Ramp {
    pub(super) fn check(&self) -> Result<(), Fault> {
        within("from_c", self.from_c, CHAMBER_C.0, CHAMBER_C.1)?;
        within("to_c", self.to_c, CHAMBER_C.0, CHAMBER_C.1)?;
        if self.from_c == self.to_c {
            return Err(Fault::new("to_c", &self.to_c, "different from `from_c`: a ramp goes somewhere"));
        }
        each_within("rates_k_per_min", &self.rates_k_per_min, 0.001, 100.0)?;
        within("soak_s", self.soak_s, 0.0, LONGEST_S)?;
        within("hold_s", self.hold_s, 0.0, LONGEST_S)?;
        within("position_deg", self.position_deg, -360.0, 360.0)
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        programme.turn_to(Position::tumble(self.position_deg)).send_to(self.from_c).wait(self.soak_s);
        for rate_k_per_min in &self.rates_k_per_min {
            let duration_s = (self.to_c - self.from_c).abs() / rate_k_per_min * 60.0;
            for target_c in [self.to_c, self.from_c] {
                programme.record_towards(target_c, duration_s).record(self.hold_s);
            }
        }
    }
}
