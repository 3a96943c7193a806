//! Bytes with their addresses to records and back.

use ihex::{ReaderError, Record, WriterError};

/// The text that puts each piece at its address.
pub fn text(pieces: &[(u32, &[u8])]) -> Result<String, WriterError> {
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
    ihex::create_object_file_representation(&records)
}

/// Bytes that lie one behind the other, and where they begin.
pub type Piece = (u32, Vec<u8>);

/// Every piece of a text, its address and its bytes up to the next gap; or the line that is wrong, and why.
pub fn pieces(text: &str) -> Result<Vec<Piece>, (usize, ReaderError)> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut base = 0_u32;
    for (index, record) in ihex::Reader::new(text).enumerate() {
        match record.map_err(|error| (index + 1, error))? {
            Record::ExtendedLinearAddress(high) => base = u32::from(high) << 16,
            Record::Data { offset, value } => {
                let at = base + u32::from(offset);
                match pieces.last_mut() {
                    Some((origin, bytes)) if origin.checked_add(bytes.len() as u32) == Some(at) => bytes.extend(value),
                    _ => pieces.push((at, value)),
                }
            }
            _ => {}
        }
    }
    Ok(pieces)
}
