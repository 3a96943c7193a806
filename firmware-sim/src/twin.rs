//! The digital twin: the physics of a resonant accelerometer in a laboratory.
//!
//! `simulation.rs` steps it through a scenario. Apart from everything that is tested against it: it shares no formula with the instrument's firmware. Its physics is
//! that of the cited papers and standards, in f64, one step a second, from a seed.

pub mod conditions;
pub mod counter;
pub mod effect;
mod lag;
pub mod noise;
pub mod noise_floor;
pub mod position;
pub mod random;
pub mod rig;
pub(crate) mod rig_error;
pub mod static_map;
pub(crate) mod thermal;
pub(crate) mod thermometer;
pub mod truth;

pub use noise::Noise;
pub use noise_floor::{NoiseFloor, noise_floor_ug};
pub use rig::Rig;
pub use static_map::StaticMap;
pub use truth::Truth;
