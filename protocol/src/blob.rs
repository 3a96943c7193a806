//! A calibration, as the device stores it.
//!
//! ```text
//! offset  0   "TPCO"                 magic
//!         4   u16 LE                 layout version
//!         6   u16 LE                 payload length n
//!         8   n bytes                payload, postcard
//!       8+n   u32 LE                 CRC-32 of everything before it
//! ```
//! The checks run in that order, so a reader of a newer layout is told so and not "corrupted".

use crate::checksum::crc32;
use crate::limits::{MAX_BLOB, MAX_CHANNELS, MAX_NAME, MAX_PARAMETERS, MAX_PROGRAM, MAX_TERMS};
use crate::weights::Weights;
use core::fmt;
use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

const MAGIC: [u8; 4] = *b"TPCO";
const HEADER: usize = 8;
const CHECKSUM: usize = 4;

/// A complete calibration: everything that turns a [`crate::Sample`] into a [`crate::Reading`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blob {
    /// Serial number of the sensor that was calibrated; empty fits any.
    pub serial: String<MAX_NAME>,
    /// First bytes of the SHA-256 of the model file that this blob was made from.
    pub provenance: [u8; 8],
    /// CRC-32 of the network's outputs on fixed inputs: a processor that computes other bits refuses the blob.
    pub proof: u32,
    /// From integers to the network's inputs, and from its output to g.
    pub scaling: Scaling,
    /// The network.
    pub weights: Weights,
    /// Where the calibration was made; outside, readings are flagged.
    pub domain: Domain,
    /// The sampling that the memories assume.
    pub timing: Timing,
    /// Names of the auxiliary channels that the terms use, in the order of [`crate::Sample::channels`].
    pub channels: Vec<String<MAX_NAME>, MAX_CHANNELS>,
    /// The physical effects beside the network.
    pub terms: Vec<Term, MAX_TERMS>,
}

/// Input and output scaling.
///
/// With x = (Δf − zero)·gain and t = (T − zero)·gain, the static reading is
/// `line[0] + line[1]·x + line[2]·t + line[3]·x·t + output_g · network(x, t)`.
/// The zeros are subtracted as integers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// Frequency difference at x = 0, µHz.
    pub delta_f_zero_uhz: i64,
    /// x per Hz.
    pub delta_f_gain_per_hz: f32,
    /// Temperature at t = 0, µ°C.
    pub temperature_zero_uc: i32,
    /// t per °C.
    pub temperature_gain_per_c: f32,
    /// The first-order instrument in front of which the network stands: constant, x, t, x·t; g.
    pub line_g: [f32; 4],
    /// g per unit of network output.
    pub output_g: f32,
}

/// The calibrated domain, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Domain {
    /// Lowest and highest frequency difference, µHz.
    pub delta_f_uhz: (i64, i64),
    /// Lowest and highest temperature, µ°C.
    pub temperature_uc: (i32, i32),
}

/// The sampling that the memories assume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// Longest time between samples across which a memory is carried on, µs; [`u32::MAX`] means any.
    pub max_gap_us: u32,
}

/// One physical effect with its coefficients. Their meaning lives in the effect's file in `firmware-core`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// The effect's number.
    pub effect: u16,
    /// Which auxiliary channel it uses, as an index into [`Blob::channels`]; 0 where it uses none.
    pub channel: u8,
    /// Coefficients and time constants in the effect's own order and units.
    pub parameters: Vec<f32, MAX_PARAMETERS>,
    /// Formula of an effect that the calibration brings along; empty where the effect has its own.
    pub program: Vec<u8, MAX_PROGRAM>,
}

/// Why bytes are no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum BlobError {
    /// Fewer bytes than the header and its length field promise.
    Truncated {
        /// Bytes there.
        found: usize,
        /// Bytes wanted.
        expected: usize,
    },
    /// The first four bytes are not "TPCO".
    NotABlob,
    /// A layout that this reader doesn't know.
    Layout {
        /// The version found.
        found: u16,
        /// The version understood.
        supported: u16,
    },
    /// The bytes changed since they were written.
    Checksum {
        /// CRC-32 computed over the bytes.
        computed: u32,
        /// CRC-32 stored behind them.
        stored: u32,
    },
    /// The checksum holds and the payload still is no calibration: the writer was faulty.
    Payload,
    /// More bytes than a device can store.
    TooLarge,
}

impl fmt::Display for BlobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated { found, expected } => write!(f, "truncated: {found} bytes, expected {expected}"),
            Self::NotABlob => write!(f, "not a calibration blob: it does not begin with \"TPCO\""),
            Self::Layout { found, supported } => {
                write!(f, "layout version {found} is not supported, only {supported} is: export the model again")
            }
            Self::Checksum { computed, stored } => {
                write!(f, "corrupted: checksum {computed:#010x}, stored {stored:#010x}")
            }
            Self::Payload => write!(f, "the checksum holds but the contents are no calibration"),
            Self::TooLarge => write!(f, "larger than the {MAX_BLOB} bytes that a device stores"),
        }
    }
}

impl core::error::Error for BlobError {}

impl Blob {
    /// The layout version that this crate reads and writes.
    pub const LAYOUT: u16 = 2;

    /// Writes the blob into `buffer` and returns the bytes used.
    ///
    /// # Errors
    /// [`BlobError::TooLarge`] if `buffer` is too small.
    pub fn to_bytes<'a>(&self, buffer: &'a mut [u8]) -> Result<&'a [u8], BlobError> {
        let payload = buffer.get_mut(HEADER..).ok_or(BlobError::TooLarge)?;
        let length = postcard::to_slice(self, payload).map_err(|_| BlobError::TooLarge)?.len();
        let length_field = u16::try_from(length).map_err(|_| BlobError::TooLarge)?;
        let end = HEADER + length;
        buffer.get_mut(..4).ok_or(BlobError::TooLarge)?.copy_from_slice(&MAGIC);
        buffer.get_mut(4..6).ok_or(BlobError::TooLarge)?.copy_from_slice(&Self::LAYOUT.to_le_bytes());
        buffer.get_mut(6..8).ok_or(BlobError::TooLarge)?.copy_from_slice(&length_field.to_le_bytes());
        let checksum = crc32(buffer.get(..end).ok_or(BlobError::TooLarge)?);
        buffer.get_mut(end..end + CHECKSUM).ok_or(BlobError::TooLarge)?.copy_from_slice(&checksum.to_le_bytes());
        buffer.get(..end + CHECKSUM).ok_or(BlobError::TooLarge)
    }

    /// The bytes that a blob at the beginning of `bytes` says it takes; `None` if no header is there.
    #[must_use]
    pub fn stored_length(bytes: &[u8]) -> Option<usize> {
        let ([m0, m1, m2, m3, _, _, n0, n1], _) = bytes.split_first_chunk::<HEADER>()?;
        let length = HEADER + usize::from(u16::from_le_bytes([*n0, *n1])) + CHECKSUM;
        ([*m0, *m1, *m2, *m3] == MAGIC && length <= MAX_BLOB).then_some(length)
    }

    /// Reads a blob from the beginning of `bytes`; what follows it (erased flash) is ignored.
    ///
    /// # Errors
    /// A [`BlobError`] that says what is wrong. Every single-bit flip and every truncation is refused.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BlobError> {
        let truncated = |expected| BlobError::Truncated { found: bytes.len(), expected };
        let (header, rest) = bytes.split_first_chunk::<HEADER>().ok_or(truncated(HEADER + CHECKSUM))?;
        let [m0, m1, m2, m3, l0, l1, n0, n1] = *header;
        if [m0, m1, m2, m3] != MAGIC {
            return Err(BlobError::NotABlob);
        }
        let found = u16::from_le_bytes([l0, l1]);
        if found != Self::LAYOUT {
            return Err(BlobError::Layout { found, supported: Self::LAYOUT });
        }
        let length = usize::from(u16::from_le_bytes([n0, n1]));
        let expected = HEADER + length + CHECKSUM;
        let (payload, rest) = rest.split_at_checked(length).ok_or(truncated(expected))?;
        let (stored, _) = rest.split_first_chunk::<CHECKSUM>().ok_or(truncated(expected))?;
        let computed = crc32(bytes.get(..HEADER + length).ok_or(truncated(expected))?);
        let stored = u32::from_le_bytes(*stored);
        if computed != stored {
            return Err(BlobError::Checksum { computed, stored });
        }
        match postcard::take_from_bytes::<Self>(payload) {
            Ok((blob, [])) => Ok(blob),
            _ => Err(BlobError::Payload),
        }
    }
}
