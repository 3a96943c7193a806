//! The kinds of run: one file a kind, one list of them here.

use serde::{Deserialize, Serialize};

use crate::scenario::limit::{Fault, each_within, up_to, within};
use crate::scenario::position::{self, Position};
use crate::scenario::programme::{Programme, Segment};
use crate::twin::random::Random;

/// Declares every kind once: name in the file, variant, and type.
macro_rules! kinds {
    ($($name:literal $module:ident $kind:ident;)*) => {
        $(mod $module; pub use $module::$kind;)*

        /// What is done in a run; `kind` in the scenario names it.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind")]
        pub enum Kind {
            $(#[doc = concat!("`kind = \"", $name, "\"`")] #[serde(rename = $name)] $kind($kind),)*
        }

        impl Kind {
            /// Every kind's name, as scenarios write it.
            pub const NAMES: &[&str] = &[$($name),*];

            /// The name as scenarios and recordings write it.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$kind(_) => $name,)* }
            }

            /// # Errors
            /// The first number that cannot be carried out.
            pub fn check(&self) -> Result<(), Fault> {
                match self { $(Self::$kind(kind) => kind.check(),)* }
            }

            /// Writes the run into `programme`.
            pub fn write(&self, programme: &mut Programme, random: &mut Random) {
                match self { $(Self::$kind(kind) => kind.write(programme, random),)* }
            }
        }
    };
}

kinds! {
    "full" full Full;
    "zero" zero Zero;
    "ramp" ramp Ramp;
    "tumble" tumble Tumble;
    "static" fixed Static;
    "soak" soak Soak;
    "power-cycle" power_cycle PowerCycle;
    "supply" supply Supply;
    "vibration" vibration Vibration;
    "pressure" pressure Pressure;
    "humidity" humidity Humidity;
}

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
    fn apply(self, positions: &mut [Position], random: &mut Random) {
        if self == Self::Random {
            random.shuffle(positions);
        }
    }
}

/// The coldest and the hottest a chamber goes, °C.
pub(super) const CHAMBER_C: (f64, f64) = (-80.0, 180.0);
/// The longest any part of a run may last: a year, s.
pub(super) const LONGEST_S: f64 = 366.0 * 86_400.0;

/// Records every position for `dwell_s`, after `settle_s` that are not kept.
fn record_positions(programme: &mut Programme, positions: &[Position], settle_s: f64, dwell_s: f64) {
    for position in positions {
        programme.turn_to(*position).wait(settle_s).record(dwell_s);
    }
}

/// Where a sweep is carried out: at every temperature, in every pose.
struct Places<'a> {
    temperatures_c: &'a [f64],
    soak_s: f64,
    positions_deg: &'a [f64],
    settle_s: f64,
    dwell_s: f64,
}

/// What is swept: the values, and how the laboratory sets one.
struct Sweep<'a> {
    values: &'a [f64],
    set: &'a dyn Fn(&mut Segment, f64),
}

impl Places<'_> {
    fn check(&self) -> Result<(), Fault> {
        each_within("temperatures_c", self.temperatures_c, CHAMBER_C.0, CHAMBER_C.1)?;
        within("soak_s", self.soak_s, 0.0, LONGEST_S)?;
        position::check(self.positions_deg, &[])?;
        within("settle_s", self.settle_s, 0.0, LONGEST_S)?;
        up_to("dwell_s", self.dwell_s, LONGEST_S)
    }

    fn sweep(&self, programme: &mut Programme, sweep: &Sweep) {
        for temperature_c in self.temperatures_c {
            programme.turn_to(Position::tumble(0.0)).send_to(*temperature_c).wait(self.soak_s);
            for position in position::collect(self.positions_deg, &[]) {
                programme.turn_to(position);
                for value in sweep.values {
                    let set = |now: &mut Segment| (sweep.set)(now, *value);
                    programme.set(set).wait(self.settle_s).record(self.dwell_s);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
