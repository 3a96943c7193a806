//! The host.

pub use std::println as say;

/// The number that stands at this place of the command line, counted from 1.
#[must_use]
pub fn number(place: usize) -> Option<u32> {
    std::env::args().nth(place)?.parse().ok()
}

/// Whether `word` stands at this place of the command line.
#[must_use]
pub fn is(place: usize, word: &str) -> bool {
    std::env::args().nth(place).is_some_and(|found| found == word)
}
