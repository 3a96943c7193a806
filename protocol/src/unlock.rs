//! What turns the instrument's challenge into the host's answer.
//!
//! This keeps stray, repeated and damaged frames from writing a calibration. It keeps no enemy out: for that
//! there are signatures.

use crate::checksum::crc32;
use crate::limits::MAX_NAME;

/// The answer to a challenge of the instrument with this serial number: the CRC-32 of the eight bytes of
/// the nonce, lowest first, and the serial number.
#[must_use]
pub fn unlock_answer(nonce: u64, serial: &str) -> u32 {
    let mut bytes = [0; 8 + MAX_NAME];
    let written = bytes.iter_mut().zip(nonce.to_le_bytes().into_iter().chain(serial.bytes()));
    let length = written.map(|(slot, byte)| *slot = byte).count();
    crc32(bytes.get(..length).unwrap_or(&bytes))
}

#[cfg(test)]
mod tests {
    use super::unlock_answer;

    #[test]
    fn the_answer_depends_on_the_challenge_and_on_the_sensor() {
        assert_eq!(unlock_answer(u64::from_le_bytes(*b"12345678"), "9"), 0xCBF4_3926);
        assert_ne!(unlock_answer(1, "SN-1"), unlock_answer(2, "SN-1"));
        assert_ne!(unlock_answer(1, "SN-1"), unlock_answer(1, "SN-2"));
    }

    #[test]
    fn a_serial_number_counts_as_far_as_a_device_stores_it() {
        let (stored, longer) = ("123456789012345678901234", "1234567890123456789012345");
        assert_eq!(unlock_answer(5, longer), unlock_answer(5, stored));
        assert_ne!(unlock_answer(5, stored), unlock_answer(5, &stored[..23]));
    }
}
