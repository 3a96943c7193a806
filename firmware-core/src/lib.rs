//! What the instrument does, from raw integers to an acceleration.
//!
//! ```text
//!              counter.rs  thermometer.rs      drivers over embedded-hal
//!                   └─────┬─────┘
//!                         │ sensors.rs         what they say and what is wrong with them
//!                      Sample                  integers of one instant
//!                         │ observe.rs         integer differences, time, then f32
//!                    Observation
//!          memory.rs ─┐   │
//!   effect/*.rs ─────→ terms.rs                what disturbs the resonators, what disturbs the output
//!   program.rs ────────┤                       a user's own formula
//!   network.rs ───────┴───┤ compensator.rs        slope.rs: only a calibration that can measure is loaded
//!                      Reading                 acceleration and its status
//!                         │ instrument.rs      the conversation: requests in, responses out
//!   stream.rs ────────────┤                    measuring at a period, unasked
//!   lock.rs ──────────────┤                    who may write
//!   calibrations.rs ──────┘                    the one in use, the next one, the one before
//!     │ signature.rs  identity.rs              whose calibrations are taken
//!   storage.rs                                 two slots of flash that survive a power cut
//! ```
//!
//! `log.rs` says what happens, to whoever debugs a device; without the feature `defmt` it is empty.
//!
//! Everything that computes is generic over [`Real`]: the device runs it in `f32`, the trainer in
//! `f64`. The `f32` results have the same bits on every processor: only + − × ÷ and comparisons in a
//! fixed order, software `exp` from `libm`, and no NaN is ever computed with.
//!
//! ```
//! use firmware_core::{Network, effect};
//! use protocol::Weights;
//!
//! let weights = Weights::from_array(&std::array::from_fn(|i| i as f32 / 41.0 - 0.5));
//! let on_the_device = Network::<f32>::new(&weights).evaluate(0.25, -0.5);
//! let in_training = Network::<f64>::new(&weights).evaluate(0.25, -0.5);
//! assert!((f64::from(on_the_device) - in_training).abs() < 1e-6);
//!
//! let lag = effect::about("thermal-lag").expect("an effect of the catalogue");
//! assert!(effect::find::<f32>(lag.id).is_some() && lag.is_on_device());
//! ```
//!
//! [`Compensator`] shows how a program of one's own measures with a calibration.
#![no_std]

pub mod activation;
mod calibrations;
mod compensator;
mod counter;
pub mod effect;
mod identity;
mod instrument;
mod load_error;
mod lock;
pub mod log;
mod memory;
mod network;
mod observe;
pub mod program;
mod real;
mod sensors;
mod signature;
mod slope;
pub mod storage;
mod stream;
mod terms;
mod thermometer;

pub use compensator::{Compensator, Output};
pub use counter::{Counter, CounterError, Pair};
pub use identity::{FactoryKey, IDENTITY, IdentityRecord};
pub use instrument::Instrument;
pub use load_error::LoadError;
pub use memory::{Memory, State};
pub use network::Network;
pub use observe::{Clock, Observation, Scale};
pub use real::Real;
pub use sensors::Sensors;
pub use storage::Storage;
pub use terms::Terms;
pub use thermometer::{Thermometer, ThermometerError};
