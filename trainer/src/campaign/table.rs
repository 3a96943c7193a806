//! A text file as a table of cells: encoding, separator, comments, header, and where each record stands.

use super::error::{CampaignError, Facts, Place, quoted};
use csv::{ByteRecord, Reader, ReaderBuilder};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// File names that may hold a table, without the dot.
const ENDINGS: [&str; 3] = ["csv", "tsv", "txt"];
/// Editors of some systems put it before UTF-8 text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// A file's text, with its header understood.
pub(super) struct Table {
    /// The file.
    pub(super) file: PathBuf,
    /// Names of the columns; a nameless column is empty.
    pub(super) header: Vec<String>,
    /// Line of the header.
    header_line: u64,
    separator: u8,
    text: String,
}

impl Table {
    /// Reads a file up to its header.
    pub(super) fn open(file: &Path) -> Result<Self, CampaignError> {
        check_ending(file)?;
        Self::of(file, read_text(file)?)
    }

    fn of(file: &Path, text: String) -> Result<Self, CampaignError> {
        let mut table = Self { file: file.to_owned(), header: Vec::new(), header_line: 1, separator: b',', text };
        table.separator = separator(&table.text);
        let mut record = ByteRecord::new();
        if !table.next(&mut table.reader(), &mut record)? {
            let expected = "a line of column names and rows below it";
            return Err(CampaignError::Empty(Facts::boxed(Place::file(file), "no content", expected)));
        }
        table.header_line = table.line(&record);
        table.header = record.iter().map(|cell| String::from_utf8_lossy(clean(cell)).into_owned()).collect();
        Ok(table)
    }

    /// A reader that stands before the first row.
    pub(super) fn rows(&self) -> Result<Reader<&[u8]>, CampaignError> {
        let mut reader = self.reader();
        self.next(&mut reader, &mut ByteRecord::new())?;
        Ok(reader)
    }

    /// Reads the next record that is not blank; `false` at the end.
    pub(super) fn next(&self, reader: &mut Reader<&[u8]>, record: &mut ByteRecord) -> Result<bool, CampaignError> {
        loop {
            let more = reader.read_byte_record(record).map_err(|error| {
                CampaignError::Unreadable(Facts::boxed(Place::file(&self.file), error.to_string(), "a readable table"))
            })?;
            if !more || !record.iter().all(|cell| clean(cell).is_empty()) {
                return Ok(more);
            }
        }
    }

    /// The line of a record. Counted when an error needs it: the reader's own line is that before skipped comments.
    pub(super) fn line(&self, record: &ByteRecord) -> u64 {
        let mut start = record.position().map_or(0, |position| position.byte() as usize);
        while let Some(rest) = self.text.as_bytes().get(start..) {
            let line = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
            let content = rest.get(..line).unwrap_or_default();
            let blank = content.iter().all(u8::is_ascii_whitespace);
            if line == rest.len() || !(blank || content.starts_with(b"#")) {
                break;
            }
            start += line + 1;
        }
        line_at(self.text.as_bytes(), start)
    }

    /// The header's place.
    pub(super) fn header_place(&self) -> Place {
        Place::file(&self.file).line(self.header_line)
    }

    fn reader(&self) -> Reader<&[u8]> {
        ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(self.separator)
            .comment(Some(b'#'))
            .from_reader(self.text.as_bytes())
    }
}

/// A cell without the blanks and quotes around it.
pub(super) fn clean(cell: &[u8]) -> &[u8] {
    match cell.trim_ascii() {
        // The reader removes quotes, but not those that stand behind a blank.
        [b'"', inner @ .., b'"'] => inner.trim_ascii(),
        inner => inner,
    }
}

/// The line, from 1, in which the byte at `offset` stands.
pub(super) fn line_at(text: &[u8], offset: usize) -> u64 {
    let before = text.get(..offset).unwrap_or(text);
    let feeds = before.iter().filter(|&&byte| byte == b'\n').count();
    let lone_returns = before.windows(2).filter(|pair| pair[0] == b'\r' && pair[1] != b'\n').count();
    (feeds + lone_returns) as u64 + 1
}

/// A file's text, without a byte order mark.
pub(super) fn read_text(file: &Path) -> Result<String, CampaignError> {
    let bytes = std::fs::read(file).map_err(|error| unreadable(file, &error))?;
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let line = line_at(bytes, valid);
        let found = format!("byte 0x{:02X}", bytes.get(valid).copied().unwrap_or_default());
        CampaignError::NotUtf8(Facts::boxed(Place::file(file).line(line), found, "UTF-8 text"))
    })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.remove(0);
    }
    Ok(text)
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

fn check_ending(file: &Path) -> Result<(), CampaignError> {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let place = Place::file(file);
    let expected = "a table as text: .csv, .tsv or .txt";
    match ending.as_deref() {
        Some("parquet" | "pq") => {
            Err(CampaignError::Parquet(Facts::boxed(place, "a Parquet file", "a table as text: .csv")))
        }
        Some(ending) if ENDINGS.contains(&ending) => Ok(()),
        Some(ending) => Err(CampaignError::UnknownFileType(Facts::boxed(
            place,
            format!("a name ending in {}", quoted(format!(".{ending}").as_bytes())),
            expected,
        ))),
        None => Err(CampaignError::UnknownFileType(Facts::boxed(place, "a name without an ending", expected))),
    }
}

/// The separator that the first line of content uses most.
fn separator(text: &str) -> u8 {
    let header = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    let count = |separator: u8| {
        let mut quoted = false;
        let outside = |byte: &&u8| {
            quoted ^= **byte == b'"';
            !quoted && **byte == separator
        };
        header.as_bytes().iter().filter(outside).count()
    };
    // The last of equals wins `max_by_key`: the comma is what people mean when nothing else speaks.
    [b'\t', b';', b','].into_iter().max_by_key(|&separator| count(separator)).unwrap_or(b',')
}
