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
    /// Check the calibration written so far, of `length` bytes, store it and use it from now on.
    CommitBlob {
        /// Bytes in all.
        length: u16,
    },
    /// A piece of the calibration in use, from `offset` on.
    ReadBlob {
        /// Bytes before the piece.
        offset: u16,
    },
    /// What is stored?
    ReadStorage,
    /// I want to write: give me a number to answer.
    Challenge,
    /// The answer to the challenge: allows one calibration to be written, or one step back.
    Unlock {
        /// See [`crate::unlock_answer`].
        answer: u32,
    },
    /// Return to the calibration that was stored before the one in use.
    RollBack,
    /// From now on, measure every `period_ms` and send what was asked for, unasked.
    Stream {
        /// What to send.
        what: Streamed,
        /// Time from one to the next, ms.
        period_ms: u32,
    },
    /// End a stream.
    Stop,
}

/// What a stream carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Streamed {
    /// Readings: [`Response::StreamedReading`].
    Readings,
    /// Raw samples: [`Response::StreamedSample`].
    Samples,
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
    /// To [`Request::ReadBlob`].
    Piece {
        /// Bytes before the piece.
        offset: u16,
        /// Bytes in all.
        length: u16,
        /// The piece.
        bytes: Vec<u8, MAX_CHUNK>,
    },
    /// To [`Request::ReadStorage`].
    Storage(StorageState),
    /// To [`Request::Challenge`].
    Nonce {
        /// What the answer is to be computed from.
        nonce: u64,
    },
    /// To [`Request::CommitBlob`]: checked and in use, but it could not be stored; the next power-on
    /// finds what was stored before.
    UntilPowerOff,
    /// Of a stream of readings, unasked.
    StreamedReading {
        /// Counts from 0 on since the stream began, so that losses are seen.
        number: u32,
        /// The reading.
        reading: Reading,
    },
    /// Of a stream of samples, unasked.
    StreamedSample {
        /// Counts from 0 on since the stream began, so that losses are seen.
        number: u32,
        /// The sample.
        sample: Sample,
    },
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

/// What the instrument stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StorageState {
    /// Where the calibration in use comes from.
    pub source: Source,
    /// Its number in the order of commits; 0 if nobody committed it.
    pub sequence: u32,
    /// Whether there is another valid one to go back to.
    pub can_roll_back: bool,
    /// How often each of both slots has been erased.
    pub erases: [u32; 2],
    /// First bytes of the factory's public key, if only calibrations signed with it are taken.
    pub key: Option<[u8; 8]>,
}

/// Where a calibration in use comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// There is none.
    Nothing,
    /// Put into flash by a programmer.
    Factory,
    /// Committed over the wire.
    Committed,
    /// Sent over the wire; storing it failed.
    UntilPowerOff,
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
    /// Writing is not unlocked, or no longer.
    Locked,
    /// The answer does not belong to the challenge, or comes too late.
    WrongAnswer,
    /// There is no other valid calibration to go back to.
    NothingBefore,
    /// The flash failed.
    StorageFailed,
    /// Not signed with the factory's key.
    Unsigned,
    /// No calibration is in use that could be read.
    NoCalibration,
    /// A stream that is too fast, or too slow to be one; the limits in ms.
    Period {
        /// Shortest period, ms.
        shortest_ms: u32,
        /// Longest period, ms.
        longest_ms: u32,
    },
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
            Self::Locked => write!(f, "writing is locked; ask for a challenge and answer it first"),
            Self::WrongAnswer => write!(f, "the answer does not belong to its challenge, or came too late"),
            Self::NothingBefore => write!(f, "no earlier calibration is stored that it could go back to"),
            Self::StorageFailed => write!(f, "its flash failed; the calibration in use runs on"),
            Self::Unsigned => write!(f, "the calibration is not signed with the factory's key that it holds"),
            Self::NoCalibration => write!(f, "it is uncalibrated"),
            Self::Period { shortest_ms, longest_ms } => {
                write!(f, "it streams every {shortest_ms} to {longest_ms} ms, no faster and no slower")
            }
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
