//! `full`: soaked temperature nodes, several positions at each.

use serde::{Deserialize, Serialize};

use super::order::{Order, record_positions};
use crate::limit::{CHAMBER_C, Fault, LONGEST_S, each_within, up_to, within};
use crate::scenario::programme::Programme;
use crate::twin::position::{self, Position};
use crate::twin::random::Random;

/// The full-temperature test of Micromachines 2022, 13(7), 1054: at every node an hour of soak, then +0, +1, −0, −1 g.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Full {
    /// Temperatures in the order in which the chamber is sent there, °C. A descending list approaches them from above.
    pub nodes_c: Vec<f64>,
    /// Time at every node before recording, s.
    pub soak_s: f64,
    /// Poses at every node; the input axis sees the sine, degrees.
    pub positions_deg: Vec<f64>,
    /// Order of the poses.
    pub order: Order,
    /// Time in every pose that is not kept, s.
    pub settle_s: f64,
    /// Time in every pose that is recorded, s.
    pub dwell_s: f64,
}

impl Default for Full {
    fn default() -> Self {
        Self {
            nodes_c: vec![-40.0, -20.0, 0.0, 20.0, 40.0, 60.0],
            soak_s: 3600.0,
            positions_deg: vec![0.0, 90.0, 180.0, 270.0],
            order: Order::Listed,
            settle_s: 0.0,
            dwell_s: 30.0,
        }
    }
}

impl Full {
    pub(super) fn check(&self) -> Result<(), Fault> {
        each_within("nodes_c", &self.nodes_c, CHAMBER_C.0, CHAMBER_C.1)?;
        within("soak_s", self.soak_s, 0.0, LONGEST_S)?;
        position::check(&self.positions_deg, &[])?;
        within("settle_s", self.settle_s, 0.0, LONGEST_S)?;
        up_to("dwell_s", self.dwell_s, LONGEST_S)
    }

    pub(super) fn write(&self, programme: &mut Programme, random: &mut Random) {
        let mut positions = position::collect(&self.positions_deg, &[]);
        for node_c in &self.nodes_c {
            self.order.apply(&mut positions, random);
            programme.turn_to(Position::tumble(0.0)).send_to(*node_c).wait(self.soak_s);
            record_positions(programme, &positions, self.settle_s, self.dwell_s);
        }
    }
}
