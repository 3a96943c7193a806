//! `tempco device read PORT -o calibration.bin`

use super::target::Target;
use crate::digits::digits;
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output};
use crate::terminal::say;
use clap::Args;
use protocol::Blob;
use std::path::PathBuf;

/// Reads the calibration in use out of an instrument, as `tempco inspect` and `tempco flash` take it.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco device read /dev/ttyUSB0 -o calibration.bin && tempco inspect calibration.bin"
)]
pub struct Read {
    #[command(flatten)]
    target: Target,

    /// Where to write it
    #[arg(short, long, value_name = "FILE", default_value = "calibration.bin")]
    output: PathBuf,

    #[command(flatten)]
    force: Force,
}

impl Read {
    pub fn run(&self) -> Result<Answer, Failure> {
        let output = Output::file(&self.output, Kind::Calibration, "-o", self.force);
        output.check()?;
        let bytes = self.target.port.connect()?.read_calibration()?;
        let name = digits(&Blob::from_bytes(&bytes)?.provenance);
        output.write(&bytes)?;
        if self.target.json {
            say!("{:#}", serde_json::json!({ "calibration": name, "bytes": bytes.len() }))?;
        } else {
            say!("Calibration {name}, {} bytes, written to {}", bytes.len(), self.output.display())?;
        }
        Ok(Answer::Yes)
    }
}
