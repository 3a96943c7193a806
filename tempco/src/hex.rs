//! Intel HEX: bytes with their addresses, as programmers take them.

use crate::failure::Failure;
use ihex::Record;
use std::path::Path;

/// The text of a file that puts each piece at its address.
pub fn text(pieces: &[(u32, &[u8])]) -> Result<String, Failure> {
    let mut records = Vec::new();
    for (origin, bytes) in pieces {
        // The pieces are short and begin at round addresses: none crosses a border of 64 KiB.
        records.push(Record::ExtendedLinearAddress((origin >> 16) as u16));
        for (index, line) in bytes.chunks(16).enumerate() {
            let offset = (*origin as u16).wrapping_add((16 * index) as u16);
            records.push(Record::Data { offset, value: line.to_vec() });
        }
    }
    records.push(Record::EndOfFile);
    ihex::create_object_file_representation(&records).map_err(Failure::new)
}

/// The first piece of a file: its bytes up to the first gap.
pub fn first_piece(file: &Path) -> Result<Vec<u8>, Failure> {
    let text = std::fs::read_to_string(file).map_err(|error| Failure::io(file, &error))?;
    let (mut base, mut bytes, mut next) = (0_u32, Vec::new(), None);
    for (line, record) in ihex::Reader::new(&text).enumerate() {
        match record.map_err(|error| Failure::new(format_args!("{}:{}: {error}", file.display(), line + 1)))? {
            Record::ExtendedLinearAddress(high) => base = u32::from(high) << 16,
            Record::Data { offset, value } => {
                let at = base + u32::from(offset);
                if *next.get_or_insert(at) == at {
                    next = Some(at + value.len() as u32);
                    bytes.extend(value);
                }
            }
            _ => {}
        }
    }
    Ok(bytes)
}
