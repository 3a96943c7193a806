//! A text file as a table of cells: encoding, separator, comments, header, and where each record stands.

use super::error::{CampaignError, Facts, Place, quoted};
use super::limits::{self, MAX_COLUMNS, MAX_FILE, MAX_NAME, MAX_RECORD};
use super::text::{line_at, read_text};
use csv::{ByteRecord, Reader, ReaderBuilder};
use std::path::{Path, PathBuf};

/// File names that may hold a table, without the dot.
const ENDINGS: [&str; 3] = ["csv", "tsv", "txt"];

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
        Self::of(file, read_text(file, MAX_FILE)?)
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
        table.check_names(&record)?;
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
            self.check_length(record)?;
            if !more || !record.iter().all(|cell| clean(cell).is_empty()) {
                return Ok(more);
            }
        }
    }

    fn check_length(&self, record: &ByteRecord) -> Result<(), CampaignError> {
        if record.as_slice().len() <= MAX_RECORD {
            return Ok(());
        }
        let place = Place::file(&self.file).line(self.line(record));
        let found = format!("a row of {}", limits::bytes(record.as_slice().len() as u64));
        Err(CampaignError::TooLong(Facts::boxed(place, found, format!("at most {}", limits::bytes(MAX_RECORD as u64)))))
    }

    fn check_names(&self, header: &ByteRecord) -> Result<(), CampaignError> {
        if header.len() > MAX_COLUMNS {
            let found = format!("{} columns", header.len());
            let expected = format!("at most {MAX_COLUMNS}");
            return Err(CampaignError::TooLong(Facts::boxed(self.header_place(), found, expected)));
        }
        let long = header.iter().position(|cell| cell.len() > MAX_NAME);
        let Some(index) = long else { return Ok(()) };
        let name = header.get(index).unwrap_or_default();
        let found =
            format!("a name of {}, {}, in column {}", limits::bytes(name.len() as u64), quoted(name), index + 1);
        let expected = format!("at most {}", limits::bytes(MAX_NAME as u64));
        Err(CampaignError::TooLong(Facts::boxed(self.header_place(), found, expected)))
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
