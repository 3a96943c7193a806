//! `tempco device …`: everything that concerns one instrument at the end of a line.

mod identify;
mod keygen;
mod monitor;
mod provision;
mod raw;
mod read;
mod rollback;
mod serve;
mod status;
mod target;
mod watch;

use crate::failure::{Answer, Failure};
use clap::{Args, Subcommand};

/// Talks to an instrument: who it is, what it measures, what it stores.
#[derive(Args)]
#[command(
    after_help = "Without hardware:  tempco device serve          starts a virtual instrument at tcp:127.0.0.1:7000\n                   tempco device monitor tcp:127.0.0.1:7000"
)]
pub struct Device {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Identify(identify::Identify),
    Status(status::Status),
    Monitor(monitor::Monitor),
    Raw(raw::Raw),
    Read(read::Read),
    Rollback(rollback::Rollback),
    Serve(serve::Serve),
    Keygen(keygen::Keygen),
    Provision(provision::Provision),
}

impl Device {
    pub fn run(&self) -> Result<Answer, Failure> {
        match &self.verb {
            Verb::Identify(command) => command.run(),
            Verb::Status(command) => command.run(),
            Verb::Monitor(command) => command.run(),
            Verb::Raw(command) => command.run(),
            Verb::Read(command) => command.run(),
            Verb::Rollback(command) => command.run(),
            Verb::Serve(command) => command.run(),
            Verb::Keygen(command) => command.run(),
            Verb::Provision(command) => command.run(),
        }
    }
}
