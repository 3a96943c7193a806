//! What is printed: the one way to standard output and standard error.
//!
//! Names of runs, columns, files and sensors come from elsewhere, and a terminal obeys what it is sent. Whatever could move
//! its cursor, colour it, or turn the direction of letters is therefore shown as the escape that JSON has for it: text stays
//! readable, JSON stays the same JSON. A standard output that takes nothing more is an error like any other.

use crate::failure::Failure;
use crate::visible::visible;
use std::io::{self, ErrorKind, Write as _};

/// Prints a line of the answer. The answer may be lost: `say!(…)?`.
macro_rules! say {
    ($($argument:tt)*) => { $crate::terminal::line(&format!($($argument)*)) };
}

/// Prints a line beside the answer.
macro_rules! remark {
    ($($argument:tt)*) => { $crate::terminal::aside(&format!($($argument)*)) };
}

pub(crate) use {remark, say};

/// Prints a line on standard output.
pub fn line(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "{}", visible(text)).and_then(|()| out.flush()).map_err(|error| lost(&error))
}

fn lost(error: &io::Error) -> Failure {
    if error.kind() == ErrorKind::BrokenPipe {
        return Failure::nobody_reads();
    }
    Failure::new(format_args!("standard output: {error}"))
        .help("make room, or let the answer go somewhere else; files that the command wrote are there")
}

/// Prints a line on standard error. What can't be said there can't be said at all.
pub fn aside(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", visible(text));
}

/// Prints why a command could not do it, with colours where there are any.
pub fn failure(failure: &Failure) {
    let _ = writeln!(anstream::stderr().lock(), "{failure}");
}

/// Prints what the parser of the command line has to say: help for whoever asks for it, or what is wrong.
pub fn usage(error: &clap::Error) -> Result<(), Failure> {
    if error.use_stderr() {
        // Without the colours: in them, those of a foreign argument could not be told from the parser's own.
        aside(error.render().to_string().trim_end());
        return Ok(());
    }
    let mut out = anstream::stdout().lock();
    write!(out, "{}", error.render().ansi()).and_then(|()| out.flush()).map_err(|error| lost(&error))
}
