//! `tumble`: many positions in the field of gravity, at one temperature after another.

use serde::{Deserialize, Serialize};

use super::order::{Order, record_positions};
use crate::limit::{CHAMBER_C, Fault, LONGEST_S, each_within, up_to, within};
use crate::scenario::programme::Programme;
use crate::twin::position::{Position, around};
use crate::twin::random::Random;

/// The multipoint test of IEEE Std 1293: the input axis sees the sine of the angle, the pendulous axis its cosine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tumble {
    /// How many poses, evenly around the circle.
    pub positions: u32,
    /// Temperatures in the order in which the chamber is sent there, °C.
    pub temperatures_c: Vec<f64>,
    /// Time at every temperature before recording, s.
    pub soak_s: f64,
    /// Order of the poses.
    pub order: Order,
    /// Time in every pose that is not kept, s.
    pub settle_s: f64,
    /// Time in every pose that is recorded, s.
    pub dwell_s: f64,
}

impl Default for Tumble {
    fn default() -> Self {
        Self {
            positions: 24,
            temperatures_c: vec![-40.0, 25.0, 60.0],
            soak_s: 3600.0,
            order: Order::Random,
            settle_s: 5.0,
            dwell_s: 10.0,
        }
    }
}

impl Tumble {
    pub(super) fn check(&self) -> Result<(), Fault> {
        within("positions", f64::from(self.positions), 2.0, 360.0)?;
        each_within("temperatures_c", &self.temperatures_c, CHAMBER_C.0, CHAMBER_C.1)?;
        within("soak_s", self.soak_s, 0.0, LONGEST_S)?;
        within("settle_s", self.settle_s, 0.0, LONGEST_S)?;
        up_to("dwell_s", self.dwell_s, LONGEST_S)
    }

    pub(super) fn write(&self, programme: &mut Programme, random: &mut Random) {
        let mut positions = around(self.positions);
        for temperature_c in &self.temperatures_c {
            self.order.apply(&mut positions, random);
            programme.turn_to(Position::tumble(0.0)).send_to(*temperature_c).wait(self.soak_s);
            record_positions(programme, &positions, self.settle_s, self.dwell_s);
        }
    }
}
