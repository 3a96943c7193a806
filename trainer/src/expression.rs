//! An effect that a user writes down: from the text to the program that a device runs, and back.

mod error;
mod parse;
mod print;
#[cfg(test)]
mod tests;
mod vocabulary;

pub use error::ExpressionError;
pub use print::print;
pub use vocabulary::{FUNCTIONS, NAMES};

use firmware_core::effect::{Parameter, Role};
use firmware_core::program::{Program, Reads, Step};
use protocol::limits::MAX_PROGRAM;
use vocabulary::steps;

/// An expression that is right in every respect for some list of channels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expression {
    text: String,
    program: Program,
    code: heapless::Vec<u8, MAX_PROGRAM>,
}

impl Expression {
    /// The expression of this text, where `channels` are in the order of a sample's.
    ///
    /// # Errors
    /// [`ExpressionError`] says where it is wrong and what was expected.
    pub fn parse(text: &str, channels: &[String]) -> Result<Self, ExpressionError> {
        let code = parse::parse(text, channels)?;
        let wrong = |found: &str, expected: &str| ExpressionError {
            text: text.to_owned(),
            column: 1,
            found: found.to_owned(),
            expected: expected.to_owned(),
            nearest: None,
        };
        if !steps(&code).any(|step| matches!(step, Step::Read(_))) {
            return Err(wrong("numbers alone", "something that is measured, such as a channel"));
        }
        // The parser writes no other; should it, the device's own words say what is wrong.
        let program = Program::new(&code).map_err(|error| wrong(&error.to_string(), "a program that a device runs"))?;
        Ok(Self { text: text.trim().to_owned(), program, code })
    }

    /// As the user wrote it.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// As a device stores it.
    #[must_use]
    pub const fn code(&self) -> &heapless::Vec<u8, MAX_PROGRAM> {
        &self.code
    }

    /// What it reads.
    #[must_use]
    pub const fn reads(&self) -> Reads {
        self.program.reads()
    }

    /// Whether this coefficient of the effect means nothing to it: a time constant, where it doesn't look back.
    #[must_use]
    pub fn leaves_idle(&self, parameter: &Parameter) -> bool {
        parameter.role == Role::Shape && !self.reads().past
    }

    /// Whether it reads this channel.
    #[must_use]
    pub fn follows(&self, channel: usize) -> bool {
        u32::try_from(channel).ok().and_then(|channel| 1_u8.checked_shl(channel)).unwrap_or(0) & self.reads().channels
            != 0
    }
}

/// Whether two texts differ in nothing but blanks.
#[must_use]
pub fn alike(a: &str, b: &str) -> bool {
    let letters = |text: &str| text.split_whitespace().collect::<String>();
    letters(a) == letters(b)
}
