//! A stored calibration and the factory's signature behind it.
//!
//! ```text
//! blob           what is signed, its own checksum included
//! "SIG1"         mark
//! 64 bytes       Ed25519 signature of the blob
//! ```
//! A reader that knows no signatures reads the blob and ignores what follows. Nothing is verified
//! here: that takes a key, and arithmetic.

use crate::blob::Blob;
use crate::checksum::crc32;
use crate::limits::SIGNATURE;

const MARK: [u8; 4] = *b"SIG1";

/// A blob's bytes, and the signature if there is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signed<'a> {
    /// The blob's own bytes.
    pub blob: &'a [u8],
    /// The signature behind them.
    pub signature: Option<&'a [u8; 64]>,
}

impl<'a> Signed<'a> {
    /// Takes apart what is stored; `None` if it does not even begin with a blob's header.
    #[must_use]
    pub fn split(bytes: &'a [u8]) -> Option<Self> {
        let (blob, rest) = bytes.split_at_checked(Blob::stored_length(bytes)?)?;
        let signature = rest.split_first_chunk::<4>().filter(|(mark, _)| **mark == MARK);
        Some(Self { blob, signature: signature.and_then(|(_, rest)| rest.first_chunk::<64>()) })
    }

    /// The bytes in all.
    #[must_use]
    pub const fn length(&self) -> usize {
        self.blob.len() + if self.signature.is_some() { SIGNATURE } else { 0 }
    }

    /// Whether the blob's own checksum holds.
    #[must_use]
    pub fn is_intact(&self) -> bool {
        self.blob.split_last_chunk::<4>().is_some_and(|(bytes, stored)| crc32(bytes) == u32::from_le_bytes(*stored))
    }

    /// What stands behind a signed blob.
    #[must_use]
    pub fn trailer(signature: &[u8; 64]) -> [u8; SIGNATURE] {
        let mut trailer = [0; SIGNATURE];
        let parts = MARK.iter().chain(signature);
        trailer.iter_mut().zip(parts).for_each(|(slot, byte)| *slot = *byte);
        trailer
    }
}

#[cfg(test)]
mod tests {
    use super::Signed;

    const BLOB: [u8; 14] = *b"TPCO\x02\x00\x02\x00abCRC!";

    #[test]
    fn a_signature_is_found_behind_the_blob_and_nowhere_else() {
        let trailer = Signed::trailer(&[7; 64]);
        let signed = [&BLOB[..], &trailer, &[0xFF; 20]].concat();
        assert_eq!(Signed::split(&signed), Some(Signed { blob: &BLOB, signature: Some(&[7; 64]) }));
        let unsigned = Some(Signed { blob: &BLOB[..], signature: None });
        assert_eq!(Signed::split(&[&BLOB[..], &[0xFF; 90]].concat()), unsigned);
        assert_eq!(Signed::split(&signed[..14 + 67]), unsigned, "cut off");
        assert_eq!(Signed::split(&signed[1..]), None);
        assert_eq!(Signed::split(&BLOB[..13]), None);
    }

    #[test]
    fn the_length_is_the_blobs_and_that_of_its_signature() {
        assert_eq!(Signed { blob: &BLOB, signature: None }.length(), 14);
        assert_eq!(Signed { blob: &BLOB, signature: Some(&[7; 64]) }.length(), 14 + 68);
    }

    #[test]
    fn a_blob_is_intact_until_any_bit_of_it_changes() {
        let mut blob = BLOB;
        let checksum = super::crc32(&blob[..10]).to_le_bytes();
        blob[10..].copy_from_slice(&checksum);
        let is_intact = |blob: &[u8]| Signed { blob, signature: None }.is_intact();
        assert!(is_intact(&blob) && !is_intact(&BLOB) && !is_intact(&blob[..3]));
        for bit in 0..14 * 8 {
            let mut changed = blob;
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(!is_intact(&changed), "bit {bit}");
        }
    }
}
