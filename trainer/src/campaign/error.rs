//! Why data was refused: a place, what was found there, what was expected. `help.rs` adds the way out.

mod help;

use protocol::limits::MAX_CHANNELS;
use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Where something was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as the caller named it; empty for the campaign as a whole.
    pub file: PathBuf,
    /// Line in the file, from 1.
    pub line: Option<u64>,
    /// The column of the table.
    pub column: Option<Column>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its number, from 1; `None` where files differ in it.
    pub number: Option<usize>,
    /// Its name as the file writes it.
    pub name: String,
    /// The data contract's name for what it holds; the same unless a mapping says otherwise.
    pub meaning: String,
}

impl Place {
    /// The campaign as a whole.
    #[must_use]
    pub fn campaign() -> Self {
        Self { file: PathBuf::new(), line: None, column: None }
    }

    /// A file as a whole.
    #[must_use]
    pub fn file(file: &Path) -> Self {
        Self { file: file.to_owned(), line: None, column: None }
    }

    /// The same place, at this line.
    #[must_use]
    pub fn line(self, line: u64) -> Self {
        Self { line: Some(line), ..self }
    }

    /// The same place, in the column of this name.
    #[must_use]
    pub fn column(self, number: Option<usize>, name: &str) -> Self {
        self.mapped_column(number, name, name)
    }

    /// The same place, in a column that is mapped to `meaning`.
    #[must_use]
    pub fn mapped_column(self, number: Option<usize>, name: &str, meaning: &str) -> Self {
        let column = Column { number, name: name.to_owned(), meaning: meaning.to_owned() };
        Self { column: Some(column), ..self }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.file.as_os_str().is_empty() {
            write!(f, "the campaign")?;
        } else {
            write!(f, "{}", self.file.display())?;
        }
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        self.column.as_ref().map_or(Ok(()), |column| write!(f, ", {column}"))
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { number, name, meaning } = self;
        match number {
            Some(number) if name == meaning => write!(f, "column {number} ({name})"),
            Some(number) => write!(f, "column {number} ({name} as {meaning})"),
            None => write!(f, "column {name}"),
        }
    }
}

/// The facts that every refusal states.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{place}: found {found}, expected {expected}")]
pub struct Facts {
    /// Where.
    pub place: Place,
    /// What stands there.
    pub found: String,
    /// What should stand there.
    pub expected: String,
}

impl Facts {
    /// The facts, boxed: an error is rare, and every `Ok` carries its size.
    pub(super) fn boxed(place: Place, found: impl Into<String>, expected: impl Into<String>) -> Box<Self> {
        Box::new(Self { place, found: found.into(), expected: expected.into() })
    }
}

/// A column that is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// The data contract's name of it.
    pub column: String,
    /// The column of the file whose name is most like what was looked for.
    pub nearest: Option<String>,
}

/// Why a campaign cannot be used. [`CampaignError::help`] says what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// No path was given.
    #[error("{0}")]
    NothingGiven(Box<Facts>),
    /// No such file or folder.
    #[error("{0}")]
    FileNotFound(Box<Facts>),
    /// The operating system refuses to read it.
    #[error("{0}")]
    Unreadable(Box<Facts>),
    /// A folder, device, pipe or socket where a file belongs.
    #[error("{0}")]
    NotAFile(Box<Facts>),
    /// A file of more bytes than anybody recorded.
    #[error("{0}")]
    TooLarge(Box<Facts>),
    /// A row, a header or a name of more than a table has.
    #[error("{0}")]
    TooLong(Box<Facts>),
    /// The name's ending is not that of a text table.
    #[error("{0}")]
    UnknownFileType(Box<Facts>),
    /// A Parquet file.
    #[error("{0}")]
    Parquet(Box<Facts>),
    /// A folder without tables.
    #[error("{0}")]
    NoTables(Box<Facts>),
    /// Bytes that are not UTF-8 text.
    #[error("{0}")]
    NotUtf8(Box<Facts>),
    /// `campaign.toml` cannot be understood.
    #[error("{0}")]
    Manifest(Box<Facts>),
    /// A file without a line of content.
    #[error("{0}")]
    Empty(Box<Facts>),
    /// A file whose first line is data.
    #[error("{0}")]
    NoHeader(Box<Facts>),
    /// A file with column names and nothing below.
    #[error("{0}")]
    HeaderOnly(Box<Facts>),
    /// Two columns of one name.
    #[error("{0}")]
    DuplicateColumn(Box<Facts>),
    /// Columns that are required, or that the mapping names.
    #[error("{facts}")]
    MissingColumn {
        /// The facts.
        facts: Box<Facts>,
        /// What is missing.
        missing: Vec<Missing>,
    },
    /// One of the two frequencies without the other.
    #[error("{0}")]
    HalfAPair(Box<Facts>),
    /// A mapping that is neither a column, a conversion of one, nor a number.
    #[error("{0}")]
    BadMapping(Box<Facts>),
    /// A reference column and a constant reference.
    #[error("{0}")]
    ReferenceTwice(Box<Facts>),
    /// More auxiliary channels than a sample holds.
    #[error("{facts}")]
    TooManyChannels {
        /// The facts; `found` names the surplus.
        facts: Box<Facts>,
        /// The channels that would fit.
        fitting: Vec<String>,
    },
    /// A row that is longer or shorter than the header.
    #[error("{0}")]
    WrongCellCount(Box<Facts>),
    /// Nothing where a value belongs.
    #[error("{0}")]
    EmptyCell(Box<Facts>),
    /// Text where a number belongs.
    #[error("{0}")]
    NotANumber(Box<Facts>),
    /// NaN or infinity.
    #[error("{0}")]
    NotFinite(Box<Facts>),
    /// A number that the instrument's integers cannot hold.
    #[error("{0}")]
    OutOfRange(Box<Facts>),
    /// A difference or sum that contradicts the two frequencies beside it.
    #[error("{0}")]
    Disagreement(Box<Facts>),
    /// Time that repeats or runs backwards within a run.
    #[error("{0}")]
    TimeNotIncreasing(Box<Facts>),
    /// One run's name in two files.
    #[error("{0}")]
    RunTwice(Box<Facts>),
    /// One run of two kinds.
    #[error("{0}")]
    KindContradiction(Box<Facts>),
    /// A channel that only some of the files have.
    #[error("{facts}")]
    ChannelsDiffer {
        /// The facts.
        facts: Box<Facts>,
        /// The channel.
        channel: String,
    },
    /// Files that were measured in different units.
    #[error("{0}")]
    QuantitiesDiffer(Box<Facts>),
    /// A single run: nothing can be held out.
    #[error("{0}")]
    OneRun(Box<Facts>),
    /// Too little data.
    #[error("{0}")]
    TooFewRows(Box<Facts>),
    /// A temperature or signal that never varies.
    #[error("{0}")]
    ConstantColumn(Box<Facts>),
    /// A reference that never varies.
    #[error("{0}")]
    ConstantReference(Box<Facts>),
    /// A signal whose whole span is a few steps of its millionth.
    #[error("{0}")]
    TooCoarse(Box<Facts>),
    /// A run to hold out that does not exist.
    #[error("{facts}")]
    UnknownRun {
        /// The facts.
        facts: Box<Facts>,
        /// The run whose name is most like it.
        nearest: Option<String>,
    },
    /// Every run would be held out.
    #[error("{0}")]
    NothingLeft(Box<Facts>),
    /// A channel that a model needs.
    #[error("{facts}")]
    MissingChannel {
        /// The facts.
        facts: Box<Facts>,
        /// The channel that is missing.
        channel: String,
        /// The channel whose name is most like it.
        nearest: Option<String>,
    },
}

impl CampaignError {
    /// Place, found and expected.
    #[must_use]
    pub fn facts(&self) -> &Facts {
        match self {
            Self::MissingColumn { facts, .. }
            | Self::TooManyChannels { facts, .. }
            | Self::ChannelsDiffer { facts, .. }
            | Self::UnknownRun { facts, .. }
            | Self::MissingChannel { facts, .. } => facts,
            Self::NothingGiven(facts) | Self::FileNotFound(facts) | Self::Unreadable(facts) => facts,
            Self::NotAFile(facts) | Self::TooLarge(facts) | Self::TooLong(facts) => facts,
            Self::UnknownFileType(facts) | Self::Parquet(facts) | Self::NoTables(facts) => facts,
            Self::NotUtf8(facts) | Self::Manifest(facts) | Self::Empty(facts) => facts,
            Self::NoHeader(facts) | Self::HeaderOnly(facts) | Self::DuplicateColumn(facts) => facts,
            Self::HalfAPair(facts) | Self::BadMapping(facts) | Self::ReferenceTwice(facts) => facts,
            Self::WrongCellCount(facts) | Self::EmptyCell(facts) | Self::NotANumber(facts) => facts,
            Self::NotFinite(facts) | Self::OutOfRange(facts) | Self::Disagreement(facts) => facts,
            Self::TimeNotIncreasing(facts) | Self::RunTwice(facts) | Self::KindContradiction(facts) => facts,
            Self::QuantitiesDiffer(facts) | Self::OneRun(facts) | Self::TooFewRows(facts) => facts,
            Self::ConstantColumn(facts) | Self::ConstantReference(facts) | Self::TooCoarse(facts) => facts,
            Self::NothingLeft(facts) => facts,
        }
    }

    /// `channels` are more than a sample holds.
    pub(super) fn too_many_channels(place: Place, channels: &[String]) -> Self {
        let (fitting, surplus) = channels.split_at(MAX_CHANNELS.min(channels.len()));
        let found = format!("{} auxiliary channels, too many by {}", channels.len(), surplus.join(", "));
        let expected = format!("at most {MAX_CHANNELS}");
        Self::TooManyChannels { facts: Facts::boxed(place, found, expected), fitting: fitting.to_vec() }
    }
}

/// `names` in a sentence: `columns a, b` or `no columns`; not longer than anybody reads.
pub(super) fn list(what: &str, names: &[String]) -> String {
    const MOST: usize = 40;
    match names.get(..MOST) {
        Some(first) if names.len() > MOST => {
            format!("{what} {} and {} more", first.join(", "), names.len() - MOST)
        }
        _ if names.is_empty() => format!("no {what}"),
        _ => format!("{what} {}", names.join(", ")),
    }
}

/// The longest piece of a cell that an error shows, in characters.
const LONGEST: usize = 40;

/// A number as an error shows it: as written, and not longer than a line.
pub(super) fn shortened(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.into_owned(),
    }
}

/// A cell as an error shows it: in quotes, and not longer than a line.
pub(super) fn quoted(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{:?}…", text.get(..end).unwrap_or_default()),
        None => format!("{text:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_names_forty_and_counts_the_rest() {
        let names = |count: usize| -> Vec<String> { (1..=count).map(|number| format!("c{number}")).collect() };
        assert_eq!(list("runs", &[]), "no runs");
        assert_eq!(list("runs", &names(2)), "runs c1, c2");
        assert!(list("columns", &names(40)).ends_with(", c39, c40"));
        assert!(list("columns", &names(41)).ends_with(", c40 and 1 more"));
        assert!(list("columns", &names(100)).ends_with(", c40 and 60 more"));
    }
}
