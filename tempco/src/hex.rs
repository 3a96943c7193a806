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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_come_back_with_their_addresses_and_stay_apart() {
        let (long, short) = ([7; 40], [9; 5]);
        let text = text(&[(0x080C_0000, &long), (0x080E_0010, &short)]).expect("HEX");
        let found = pieces(&text).expect("HEX");
        assert_eq!(found, [(0x080C_0000, long.to_vec()), (0x080E_0010, short.to_vec())]);
        let folder = tempfile::TempDir::new().expect("a folder");
        let file = folder.path().join("a.hex");
        std::fs::write(&file, &text).expect("written");
        assert_eq!(first_piece(&file).expect("HEX"), long);
        // A line that is wrong is named.
        let broken: Vec<&str> = text.lines().enumerate().map(|(at, line)| if at == 2 { ":zz" } else { line }).collect();
        std::fs::write(&file, broken.join("\n")).expect("written");
        let error = first_piece(&file).expect_err("broken").to_string();
        assert!(error.contains("a.hex:3: "), "{error}");
    }
}
