//! Poses one after the other, and in which order.

use serde::{Deserialize, Serialize};

use crate::scenario::programme::Programme;
use crate::twin::position::Position;
use crate::twin::random::Random;

/// In which order positions are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// As listed.
    #[default]
    Listed,
    /// Shuffled, anew at every temperature: the position is then not confounded with what was before it.
    Random,
}

impl Order {
    pub(super) fn apply(self, positions: &mut [Position], random: &mut Random) {
        if self == Self::Random {
            random.shuffle(positions);
        }
    }
}

/// Records every position for `dwell_s`, after `settle_s` that are not kept.
pub(super) fn record_positions(programme: &mut Programme, positions: &[Position], settle_s: f64, dwell_s: f64) {
    for position in positions {
        programme.turn_to(*position).wait(settle_s).record(dwell_s);
    }
}
