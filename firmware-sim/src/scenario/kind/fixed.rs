//! `static`: one temperature, some positions.

use serde::{Deserialize, Serialize};

use super::order::{Order, record_positions};
use crate::limit::{CHAMBER_C, Fault, LONGEST_S, up_to, within};
use crate::scenario::programme::Programme;
use crate::twin::position::{self, Position};
use crate::twin::random::Random;

/// The short test that is repeated over months. Levels beyond 1 g are a centrifuge's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Static {
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Time at that temperature before recording, s.
    pub soak_s: f64,
    /// Poses; the input axis sees the sine, degrees.
    pub positions_deg: Vec<f64>,
    /// Levels that are taken after the poses, g.
    pub levels_g: Vec<f64>,
    /// Order of all of them.
    pub order: Order,
    /// Time in every pose that is not kept, s.
    pub settle_s: f64,
    /// Time in every pose that is recorded, s.
    pub dwell_s: f64,
}

impl Default for Static {
    fn default() -> Self {
        Self {
            temperature_c: 25.0,
            soak_s: 3600.0,
            positions_deg: vec![0.0, 90.0, 180.0, 270.0],
            levels_g: vec![],
            order: Order::Listed,
            settle_s: 5.0,
            dwell_s: 30.0,
        }
    }
}

impl Static {
    pub(super) fn check(&self) -> Result<(), Fault> {
        within("temperature_c", self.temperature_c, CHAMBER_C.0, CHAMBER_C.1)?;
        within("soak_s", self.soak_s, 0.0, LONGEST_S)?;
        position::check(&self.positions_deg, &self.levels_g)?;
        within("settle_s", self.settle_s, 0.0, LONGEST_S)?;
        up_to("dwell_s", self.dwell_s, LONGEST_S)
    }

    pub(super) fn write(&self, programme: &mut Programme, random: &mut Random) {
        let mut positions = position::collect(&self.positions_deg, &self.levels_g);
        self.order.apply(&mut positions, random);
        programme.turn_to(Position::tumble(0.0)).send_to(self.temperature_c).wait(self.soak_s);
        record_positions(programme, &positions, self.settle_s, self.dwell_s);
    }
}
