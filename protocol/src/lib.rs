//! What host and instrument say to each other.
//!
//! ```text
//! Sample   raw integers of one instant            sample.rs
//! Reading  acceleration and its status            reading.rs
//! Blob     a calibration, as the device stores it blob.rs, weights.rs, signature.rs
//! Unlock   what allows a host to write one        unlock.rs
//! Request, Response                               message.rs
//! bytes on the line                               frame.rs
//! every bound in one place                        limits.rs
//! ```
//!
//! This crate evaluates nothing: it knows how a calibration is written down, not what it means.
//! `docs/wire.md` specifies the bytes; the tests of this crate hold them still.
//!
//! A host asks, and the instrument understands it byte by byte:
//!
//! ```
//! use protocol::{Decoder, Envelope, Request, encode_request};
//!
//! let asked = Envelope { sequence: 7, body: Request::Identify };
//! let line = encode_request(&asked)?;
//! let mut decoder = Decoder::new();
//! let mut heard = line.iter().filter_map(|byte| decoder.push::<Request>(*byte));
//! assert_eq!(heard.next(), Some(Ok(asked)));
//!
//! // A bit that changes on the way is noticed.
//! let mut spoilt = line.clone();
//! spoilt[1] ^= 1;
//! assert!(spoilt.iter().filter_map(|byte| decoder.push::<Request>(*byte)).all(|message| message.is_err()));
//! # Ok::<(), protocol::FrameError>(())
//! ```
#![no_std]

mod blob;
mod checksum;
mod frame;
pub mod limits;
mod message;
mod reading;
mod sample;
mod signature;
mod unlock;
mod weights;

pub use blob::{Blob, BlobError, Domain, Scaling, Term, Timing};
pub use checksum::crc32;
pub use frame::{Decoder, FrameError, Line, encode_frame, encode_request, encode_response};
pub use message::{Envelope, Identity, InstrumentState, Refusal, Request, Response, Source, StorageState, Streamed};
pub use reading::{Reading, Status};
pub use sample::Sample;
pub use signature::Signed;
pub use unlock::unlock_answer;
pub use weights::Weights;
