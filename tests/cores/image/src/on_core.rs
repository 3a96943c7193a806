//! A core under an emulator that answers semihosting calls.

pub use semihosting::println as say;

/// Bytes of the longest command line.
const LINE: usize = 256;

/// The number that stands at this place of the command line, counted from 1.
#[must_use]
pub fn number(place: usize) -> Option<u32> {
    let arguments = semihosting::experimental::env::args::<LINE>().ok()?;
    (&arguments).into_iter().nth(place)?.ok()?.parse().ok()
}

/// The word that stands at this place of the command line, if it is `word`.
#[must_use]
pub fn is(place: usize, word: &str) -> bool {
    let arguments = semihosting::experimental::env::args::<LINE>();
    arguments.is_ok_and(|arguments| (&arguments).into_iter().nth(place) == Some(Ok(word)))
}

/// Ends the emulator.
pub fn end() -> ! {
    semihosting::process::exit(0)
}
