//! A file as text: what is no file, too large, or no text is refused before anything looks at it.

use super::error::{CampaignError, Facts, Place};
use super::limits;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Editors of some systems put it before UTF-8 text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// A file's text of at most `longest` bytes, without a byte order mark.
pub(super) fn read_text(file: &Path, longest: u64) -> Result<String, CampaignError> {
    let bytes = read_bytes(file, longest)?;
    // Text in UTF-16 is valid UTF-8 as well, with a NUL beside every letter.
    if let Some(nul) = bytes.iter().position(|&byte| byte == 0) {
        return Err(no_text(file, &bytes, nul));
    }
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        no_text(file, error.as_bytes(), valid)
    })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.remove(0);
    }
    Ok(text)
}

fn no_text(file: &Path, bytes: &[u8], at: usize) -> CampaignError {
    let found = format!("byte 0x{:02X}", bytes.get(at).copied().unwrap_or_default());
    let place = Place::file(file).line(line_at(bytes, at));
    CampaignError::NotUtf8(Facts::boxed(place, found, "UTF-8 text"))
}

fn read_bytes(file: &Path, longest: u64) -> Result<Vec<u8>, CampaignError> {
    // Asked before it is opened: to open a pipe that nobody writes to never returns.
    let about = file.metadata().map_err(|error| unreadable(file, &error))?;
    if !about.is_file() {
        let found = if about.is_dir() { "a folder" } else { "a device, pipe or socket" };
        return Err(CampaignError::NotAFile(Facts::boxed(Place::file(file), found, "a file")));
    }
    let mut bytes = Vec::new();
    let opened = File::open(file).map_err(|error| unreadable(file, &error))?;
    // One more than may be: whatever the system says of its length, a file may grow.
    opened.take(longest + 1).read_to_end(&mut bytes).map_err(|error| unreadable(file, &error))?;
    if bytes.len() as u64 <= longest {
        return Ok(bytes);
    }
    let found = limits::bytes(about.len().max(bytes.len() as u64));
    let expected = format!("at most {}", limits::bytes(longest));
    Err(CampaignError::TooLarge(Facts::boxed(Place::file(file), found, expected)))
}

/// Why the operating system does not let us read it.
pub(super) fn unreadable(file: &Path, error: &std::io::Error) -> CampaignError {
    let place = Place::file(file);
    if error.kind() == ErrorKind::NotFound {
        CampaignError::FileNotFound(Facts::boxed(place, "no such file or folder", "a .csv file or a folder of them"))
    } else {
        CampaignError::Unreadable(Facts::boxed(place, error.to_string(), "a readable file"))
    }
}

/// The line, from 1, in which the byte at `offset` stands.
pub(super) fn line_at(text: &[u8], offset: usize) -> u64 {
    let before = text.get(..offset).unwrap_or(text);
    let feeds = before.iter().filter(|&&byte| byte == b'\n').count();
    // Of a carriage return, the byte behind it says whether the line ends there: for the last one that is at the offset.
    let ends = |&(at, byte): &(usize, &u8)| *byte == b'\r' && text.get(at + 1) != Some(&b'\n');
    let lone_returns = before.iter().enumerate().filter(ends).count();
    (feeds + lone_returns) as u64 + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_as_it_does_on_any_system() {
        let text = b"a\rb\rc\r\nd\ne";
        for (letter, line) in [(b'a', 1), (b'b', 2), (b'c', 3), (b'd', 4), (b'e', 5)] {
            let offset = text.iter().position(|&byte| byte == letter).expect("it is there");
            assert_eq!(line_at(text, offset), line, "{}", char::from(letter));
        }
        assert_eq!(line_at(text, 99), 5);
        assert_eq!((line_at(b"a\r\nb", 1), line_at(b"a\r\nb", 2)), (1, 1), "both bytes of the end belong to the line");
    }
}
