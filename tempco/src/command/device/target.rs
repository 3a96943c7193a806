//! What every verb for an instrument must know.

use crate::link::{PORTS, Port};
use clap::Args;

/// Which instrument, and how to print what it says.
#[derive(Args)]
pub struct Target {
    #[arg(help = format!("Where the instrument is: {PORTS}"))]
    pub port: Port,

    /// Prints JSON instead of text
    #[arg(long)]
    pub json: bool,
}
