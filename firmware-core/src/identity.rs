//! Who the sensor is, as production leaves it in a memory of its own.
//!
//! ```text
//! offset  0   serial number: printable ASCII up to the first other byte, at most 24
//!        32   "KEY1"            or erased: calibrations need no signature
//!        36   32 bytes          the factory's Ed25519 public key
//!        68   u32 LE            CRC-32 of the 36 bytes before it
//! ```

use heapless::String;
use protocol::crc32;
use protocol::limits::MAX_NAME;

/// Bytes of the record.
pub const IDENTITY: usize = 72;

const KEY_AT: usize = 32;
const MARK: [u8; 4] = *b"KEY1";

/// The identity record, taken apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IdentityRecord {
    /// The sensor's serial number; empty if there is none, as in erased flash. Such an instrument accepts only a
    /// calibration that fits any sensor.
    pub serial: String<MAX_NAME>,
    /// Whose calibrations it takes.
    pub key: FactoryKey,
}

/// Whether calibrations must be signed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FactoryKey {
    /// They need not.
    NotAsked,
    /// By the owner of this public key.
    Asked([u8; 32]),
    /// There was a key once and it can't be read any more: nothing is accepted.
    Spoilt,
}

impl IdentityRecord {
    /// Of a sensor with this serial number, cut to what a record holds, and no key.
    #[must_use]
    pub fn new(serial: &str) -> Self {
        Self { serial: serial_number(serial.as_bytes()), key: FactoryKey::NotAsked }
    }

    /// Takes a record apart.
    #[must_use]
    pub fn from_bytes(record: &[u8; IDENTITY]) -> Self {
        let key = record.split_last_chunk::<{ IDENTITY - KEY_AT }>().map(|(_, key)| factory_key(key));
        Self { serial: serial_number(record), key: key.unwrap_or(FactoryKey::Spoilt) }
    }

    /// As production writes it.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; IDENTITY] {
        let mut record = [0xFF; IDENTITY];
        record.iter_mut().zip(self.serial.bytes()).for_each(|(slot, byte)| *slot = byte);
        if let FactoryKey::Asked(key) = &self.key {
            let mut marked = [0; 36];
            marked.iter_mut().zip(MARK.iter().chain(key)).for_each(|(slot, byte)| *slot = *byte);
            let bytes = marked.into_iter().chain(crc32(&marked).to_le_bytes());
            record.iter_mut().skip(KEY_AT).zip(bytes).for_each(|(slot, byte)| *slot = byte);
        }
        record
    }
}

fn factory_key(record: &[u8; IDENTITY - KEY_AT]) -> FactoryKey {
    // Erased flash; an emulator's flash is zero where nobody wrote.
    if record.iter().all(|byte| *byte == 0xFF) || record.iter().all(|byte| *byte == 0) {
        return FactoryKey::NotAsked;
    }
    let intact = record.split_last_chunk::<4>().filter(|(key, sum)| crc32(key) == u32::from_le_bytes(**sum));
    let key = intact.and_then(|(key, _)| key.strip_prefix(&MARK)).and_then(|key| key.first_chunk::<32>());
    key.map_or(FactoryKey::Spoilt, |key| FactoryKey::Asked(*key))
}

/// The printable ASCII characters at the beginning of a record.
fn serial_number(record: &[u8]) -> String<MAX_NAME> {
    let mut number = String::new();
    for byte in record.iter().take_while(|byte| byte.is_ascii_graphic()) {
        if number.push(char::from(*byte)).is_err() {
            break;
        }
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_holds_the_number_up_to_the_first_other_byte() {
        let table: [(&[u8], &str); 6] = [
            (b"SN-0042\xFF\xFF\xFF", "SN-0042"),
            (b"SN-0042\0SN", "SN-0042"),
            (b"123456789012345678901234", "123456789012345678901234"),
            (b"1234567890123456789012345", "123456789012345678901234"),
            (b"\xFF\xFF\xFF\xFF", ""),
            (b"", ""),
        ];
        for (record, number) in table {
            assert_eq!(serial_number(record), number);
        }
    }

    #[test]
    fn a_record_is_read_as_it_was_written() {
        for key in [FactoryKey::NotAsked, FactoryKey::Asked([0xA5; 32])] {
            let record = IdentityRecord { key, ..IdentityRecord::new("123456789012345678901234") };
            assert_eq!(IdentityRecord::from_bytes(&record.to_bytes()), record);
        }
        assert_eq!(IdentityRecord::from_bytes(&[0; IDENTITY]), IdentityRecord::new(""));
    }

    #[test]
    fn a_key_with_any_bit_changed_is_spoilt_and_never_forgotten() {
        let record = IdentityRecord { key: FactoryKey::Asked([0xA5; 32]), ..IdentityRecord::new("SN") }.to_bytes();
        for bit in KEY_AT * 8..IDENTITY * 8 {
            let mut record = record;
            record[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(IdentityRecord::from_bytes(&record).key, FactoryKey::Spoilt);
        }
    }
}
