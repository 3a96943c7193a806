//! `zero`: the zero-bias test, from power-on, in a room that drifts.

use serde::{Deserialize, Serialize};

use crate::limit::{Fault, LONGEST_S, up_to, within};
use crate::scenario::programme::Programme;
use crate::twin::position::Position;
use crate::twin::random::Random;

/// Recording begins at power-on, from cold. By default the input axis is level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Zero {
    /// Recorded time, s.
    pub duration_s: f64,
    /// Drift of the room, K/h.
    pub drift_k_per_h: f64,
    /// The pose; the input axis sees the sine, degrees.
    pub position_deg: f64,
}

impl Default for Zero {
    fn default() -> Self {
        Self { duration_s: 5400.0, drift_k_per_h: 0.4, position_deg: 0.0 }
    }
}

impl Zero {
    pub(super) fn check(&self) -> Result<(), Fault> {
        up_to("duration_s", self.duration_s, LONGEST_S)?;
        within("drift_k_per_h", self.drift_k_per_h, -20.0, 20.0)?;
        within("position_deg", self.position_deg, -360.0, 360.0)
    }

    pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
        let end_c = programme.setpoint_c() + self.drift_k_per_h * self.duration_s / 3600.0;
        programme.turn_to(Position::tumble(self.position_deg)).record_towards(end_c, self.duration_s);
    }
}
