//! The conversation. Both enums are append-only: a number, once released, keeps its meaning.

use crate::blob::BlobError;
use crate::limits::{MAX_CHUNK, MAX_NAME};
use crate::reading::{Reading, Status};
use crate::sample::Sample;
use core::fmt;
use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

/// What travels in a frame: a message and the number that ties an answer to its question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelope<T> {
    /// Chosen by the host, repeated by the instrument. A request with the number of the one before
    /// is a repetition: it is answered again and not carried out again. 0 is never a repetition.
    pub sequence: u16,
    /// The message.
    pub body: T,
}

/// Host to instrument.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Request {
    /// Who are you?
    Identify,
    /// How are you?
    ReadState,
    /// Measure now, and answer with raw sample and reading.
    Measure,
    /// Forget lags and hysteresis as at power-on.
    Restart,
    /// Compensate this sample instead of a measured one.
    Replay(Sample),
    /// A piece of a new calibration, `offset` bytes from its beginning. Offset 0 starts anew.
    WriteBlob {
        /// Bytes before this piece.
        offset: u16,
        /// The piece.
        bytes: Vec<u8, MAX_CHUNK>,
    },
    /// Check the calibration written so far, of `length` bytes, and use it from now on.
    CommitBlob {
        /// Bytes in all.
        length: u16,
    },
}

/// Instrument to host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Response {
    /// To [`Request::Identify`].
    Identity(Identity),
    /// To [`Request::ReadState`].
    State(InstrumentState),
    /// To [`Request::Measure`].
    Measured {
        /// What the drivers read.
        sample: Sample,
        /// What the compensator made of it.
        reading: Reading,
    },
    /// To [`Request::Replay`].
    Reading(Reading),
    /// Done as asked.
    Done,
    /// Not done, and why; nothing changed.
    Refused(Refusal),
}

/// Who the instrument is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Serial number.
    pub serial: String<MAX_NAME>,
    /// Blob layout that it reads.
    pub blob_layout: u16,
    /// Highest effect number that it knows.
    pub effects: u16,
}

/// How the instrument is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InstrumentState {
    /// Provenance of the calibration in use; `None` while uncalibrated.
    pub provenance: Option<[u8; 8]>,
    /// Readings since power-on.
    pub readings: u32,
    /// Every flag raised since power-on.
    pub raised: Status,
}

/// Why a request was not carried out.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Refusal {
    /// The piece does not continue what was written before; resend from this offset.
    Offset(u16),
    /// The bytes are no blob.
    NotABlob,
    /// The bytes end too early.
    Truncated,
    /// A layout that this firmware doesn't know.
    Layout(u16),
    /// The bytes changed on the way.
    Checksum,
    /// A well-formed blob that this firmware can't run: unknown effect, impossible numbers, other bits.
    Unusable,
    /// For another sensor.
    OtherSerial,
    /// A message that this firmware doesn't know.
    UnknownRequest,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Offset(offset) => write!(f, "a piece of the calibration is missing from byte {offset} on"),
            Self::NotABlob => write!(f, "these bytes are no calibration blob"),
            Self::Truncated => write!(f, "the calibration ends too early"),
            Self::Layout(found) => write!(f, "blob layout {found} is unknown to its firmware"),
            Self::Checksum => write!(f, "the calibration's bytes changed on the way"),
            Self::Unusable => write!(f, "its firmware can't run this calibration"),
            Self::OtherSerial => write!(f, "the calibration belongs to another sensor"),
            Self::UnknownRequest => write!(f, "its firmware doesn't know this request"),
        }
    }
}

impl core::error::Error for Refusal {}

impl From<BlobError> for Refusal {
    fn from(error: BlobError) -> Self {
        match error {
            BlobError::Truncated { .. } => Self::Truncated,
            BlobError::NotABlob => Self::NotABlob,
            BlobError::Layout { found, .. } => Self::Layout(found),
            BlobError::Checksum { .. } => Self::Checksum,
            BlobError::Payload | BlobError::TooLarge => Self::Unusable,
        }
    }
}
