//! What the instrument does, from raw integers to an acceleration.
//!
//! ```text
//!              counter.rs  thermometer.rs      drivers over embedded-hal
//!                   └─────┬─────┘
//!                      Sample                  integers of one instant
//!                         │ observe.rs         integer differences, time, then f32
//!                    Observation
//!          memory.rs ─┐   │
//!   effect/*.rs ─────→ terms.rs                what disturbs the resonators, what disturbs the output
//!   program.rs ────────┤                       a user's own formula
//!   network.rs ───────┴───┤ compensator.rs
//!                      Reading                 acceleration and its status
//!                         │ instrument.rs      the conversation: requests in, responses out
//! ```
//!
//! `log.rs` says what happens, to whoever debugs a device; without the feature `defmt` it is empty.
//!
//! Everything that computes is generic over [`Real`]: the device runs it in `f32`, the trainer in
//! `f64`. The `f32` results have the same bits on every processor: only + − × ÷ and comparisons in a
//! fixed order, software `exp` from `libm`, and no NaN is ever computed with.
#![no_std]

pub mod activation;
mod compensator;
mod counter;
pub mod effect;
mod identity;
mod instrument;
pub mod log;
mod memory;
mod network;
mod observe;
pub mod program;
mod real;
mod terms;
mod thermometer;

pub use compensator::{Compensator, LoadError, Output};
pub use counter::{Counter, CounterError, Pair};
pub use identity::serial_number;
pub use instrument::{Instrument, Sensors};
pub use memory::{Memory, State};
pub use network::Network;
pub use observe::{Clock, Observation, Scale};
pub use real::Real;
pub use terms::Terms;
pub use thermometer::{Thermometer, ThermometerError};
