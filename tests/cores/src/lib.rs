//! What every core must compute with the same bits: one source, on the host and on each core that can be emulated.
//!
//! ```text
//! calibrations.rs   every effect of the registry, users' own programs, scales at the ends of f32
//! samples.rs        an endless stream of samples, from integers alone
//! numbers.rs        the floats that a network alone is tried with
//! digest.rs         a running hash of everything that comes out
//! parity.rs         the parts whose bits are compared
//! ../image          the programs: start-up, memory maps, printing
//! ```
#![no_std]

pub mod calibrations;
mod digest;
mod numbers;
pub mod parity;
mod samples;

pub use digest::Digest;
pub use numbers::Numbers;
pub use samples::Samples;
