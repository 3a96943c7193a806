//! The kinds of run: one file a kind, sweeps together in one; one list of them here.

use serde::{Deserialize, Serialize};

use crate::limit::Fault;
use crate::scenario::programme::Programme;
use crate::twin::random::Random;

mod fixed;
mod full;
mod order;
mod power_cycle;
mod ramp;
mod soak;
mod sweep;
mod tumble;
mod zero;

pub use fixed::Static;
pub use full::Full;
pub use order::Order;
pub use power_cycle::PowerCycle;
pub use ramp::Ramp;
pub use soak::Soak;
pub use sweep::{Humidity, Pressure, Supply, Vibration};
pub use tumble::Tumble;
pub use zero::Zero;

/// Declares every kind once: name in the file, and variant, which is also its type.
macro_rules! kinds {
    ($($name:literal $kind:ident;)*) => {
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
    "full" Full;
    "zero" Zero;
    "ramp" Ramp;
    "tumble" Tumble;
    "static" Static;
    "soak" Soak;
    "power-cycle" PowerCycle;
    "supply" Supply;
    "vibration" Vibration;
    "pressure" Pressure;
    "humidity" Humidity;
}

#[cfg(test)]
mod tests;
