//! The one checksum of the product: CRC-32 as in Ethernet and zip (IEEE 802.3).

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

// Without a table: 1 KiB of flash is worth more here than the microseconds it saves once per load.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// CRC-32 (IEEE 802.3) of `bytes`. Detects every change confined to 32 adjacent bits.
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_check_value_of_the_catalogue_of_crcs() {
        assert_eq!(super::crc32(b"123456789"), 0xCBF4_3926);
    }
}
