//! The sensor's serial number, as production leaves it in a memory of its own.

use heapless::String;
use protocol::limits::MAX_NAME;

/// The serial number at the beginning of a record: its printable ASCII characters up to the first
/// other byte. Empty if there is none, as in erased flash: such an instrument accepts only a
/// calibration that fits any sensor.
#[must_use]
pub fn serial_number(record: &[u8]) -> String<MAX_NAME> {
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
    use super::serial_number;

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
}
