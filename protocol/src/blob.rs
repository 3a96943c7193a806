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

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Blob {
        Blob {
            serial: String::try_from("SN-1").expect("short"),
            provenance: *b"12345678",
            proof: 7,
            scaling: Scaling {
                delta_f_zero_uhz: 1,
                delta_f_gain_per_hz: 2.0,
                temperature_zero_uc: 3,
                temperature_gain_per_c: 4.0,
                line_g: [5.0; 4],
                output_g: 6.0,
            },
            weights: Weights::ZERO,
            domain: Domain { delta_f_uhz: (-1, 1), temperature_uc: (-2, 2) },
            timing: Timing { max_gap_us: 9 },
            channels: Vec::new(),
            terms: Vec::new(),
        }
    }

    #[test]
    fn header_payload_and_checksum_stand_where_the_layout_says() {
        let mut buffer = [0xAA; MAX_BLOB];
        let bytes = example().to_bytes(&mut buffer).expect("it fits");
        let (header, rest) = bytes.split_first_chunk::<8>().expect("a header");
        let (payload, checksum) = rest.split_last_chunk::<4>().expect("a checksum");
        assert_eq!(header[..6], *b"TPCO\x02\x00");
        assert_eq!(u16::from_le_bytes([header[6], header[7]]), payload.len() as u16);
        assert_eq!(postcard::from_bytes(payload), Ok(example()));
        assert_eq!(u32::from_le_bytes(*checksum), crc32(&bytes[..8 + payload.len()]));
    }

    #[test]
    fn what_was_written_is_read_also_with_something_behind_it() {
        let mut buffer = [0xFF; MAX_BLOB];
        let length = example().to_bytes(&mut buffer).expect("it fits").len();
        assert_eq!(Blob::from_bytes(&buffer[..length]), Ok(example()));
        assert_eq!(Blob::from_bytes(&buffer), Ok(example()));
        assert_eq!(Blob::stored_length(&buffer), Some(length));
    }

    #[test]
    fn what_is_missing_is_counted() {
        let mut buffer = [0; MAX_BLOB];
        let bytes = example().to_bytes(&mut buffer).expect("it fits");
        for found in 0..bytes.len() {
            let expected = if found < 8 { 12 } else { bytes.len() };
            assert_eq!(Blob::from_bytes(&bytes[..found]), Err(BlobError::Truncated { found, expected }));
        }
    }

    #[test]
    fn a_length_is_believed_behind_the_magic_only_and_up_to_what_a_device_stores() {
        let header = |magic: &[u8; 4], payload: u16| {
            let mut header = [0; 8];
            header[..4].copy_from_slice(magic);
            header[6..].copy_from_slice(&payload.to_le_bytes());
            Blob::stored_length(&header)
        };
        assert_eq!(header(b"TPCO", 0), Some(12));
        assert_eq!(header(b"TPCO", MAX_BLOB as u16 - 12), Some(MAX_BLOB));
        assert_eq!(header(b"TPCO", MAX_BLOB as u16 - 11), None);
        assert_eq!(header(b"TPCQ", 0), None);
    }

    #[test]
    fn each_damage_has_its_name() {
        let mut buffer = [0; MAX_BLOB];
        let length = example().to_bytes(&mut buffer).expect("it fits").len();
        let read = |change: fn(&mut [u8])| {
            let mut bytes = buffer;
            change(&mut bytes);
            let end = usize::from(u16::from_le_bytes([bytes[6], bytes[7]])) + 8;
            (Blob::from_bytes(&bytes), bytes, end)
        };
        assert_eq!(read(|bytes| bytes[0] = b'X').0, Err(BlobError::NotABlob));
        assert_eq!(read(|bytes| bytes[4] = 3).0, Err(BlobError::Layout { found: 3, supported: 2 }));
        let (changed, bytes, end) = read(|bytes| bytes[20] ^= 1);
        let stored = u32::from_le_bytes(*buffer[..length].last_chunk().expect("a checksum"));
        assert_eq!(changed, Err(BlobError::Checksum { computed: crc32(&bytes[..end]), stored }));
        let (_, mut surplus, end) = read(|bytes| bytes[6] += 1);
        let checksum = crc32(&surplus[..end]).to_le_bytes();
        surplus[end..end + 4].copy_from_slice(&checksum);
        assert_eq!(Blob::from_bytes(&surplus), Err(BlobError::Payload), "a byte too many under a right checksum");
    }
}
