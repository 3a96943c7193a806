//! Temperature and error compensation for resonant accelerometers: the command line.
//!
//! A command parses, calls the library and renders; it computes nothing.

mod command;
mod data;
mod digits;
mod failure;
mod hex;
mod key;
mod link;
mod output;
mod page;
mod plot;
mod progress;
mod recordings;
mod region;
mod render;
mod report;
mod shell;
mod subject;
mod table;
mod terminal;
mod verbs;
mod visible;
mod workbench;

use clap::Parser;
use std::process::ExitCode;

/// Temperature and error compensation for resonant accelerometers.
///
/// Train a compensation model from calibration measurements, see where it fails, and put it on the
/// sensor's microcontroller with the same bits that this computer computed.
///
/// Exit codes: 0 yes, 1 the answer is no (verify differs, a limit is exceeded), 2 could not.
#[derive(Parser)]
#[command(name = "tempco", version, after_help = "Start with:  tempco demo")]
struct Cli {
    #[command(subcommand)]
    command: verbs::Command,
}

/// What a shell says of any tool whose reader went away, as `head` does.
const NOBODY_READS: u8 = 141;

fn main() -> ExitCode {
    let outcome = match Cli::try_parse() {
        Ok(cli) => cli.command.run().map(ExitCode::from),
        Err(error) => terminal::usage(&error).map(|()| ExitCode::from(if error.use_stderr() { 2 } else { 0 })),
    };
    outcome.unwrap_or_else(|failure| {
        if failure.is_nobody_reads() {
            return ExitCode::from(NOBODY_READS);
        }
        terminal::failure(&failure);
        ExitCode::from(2)
    })
}
