//! Intel HEX: bytes with their addresses, as programmers take them.

mod records;

pub use records::pieces;

use crate::failure::Failure;
use std::path::Path;

/// The text of a file that puts each piece at its address.
pub fn text(pieces: &[(u32, &[u8])]) -> Result<String, Failure> {
    records::text(pieces).map_err(Failure::new)
}

/// The first piece of a file: its bytes up to the first gap.
pub fn first_piece(file: &Path) -> Result<Vec<u8>, Failure> {
    let text = std::fs::read_to_string(file).map_err(|error| Failure::io(file, &error))?;
    let pieces =
        pieces(&text).map_err(|(line, error)| Failure::new(format_args!("{}:{line}: {error}", file.display())))?;
    Ok(pieces.into_iter().next().map(|(_, bytes)| bytes).unwrap_or_default())
}
