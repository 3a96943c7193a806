//! `tempco device read PORT -o calibration.bin`

use super::Target;
use crate::failure::{Answer, Failure};
use crate::key::digits;
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
}

impl Read {
    pub fn run(&self) -> Result<Answer, Failure> {
        let bytes = self.target.port.connect()?.read_calibration()?;
        let name = digits(&Blob::from_bytes(&bytes)?.provenance);
        std::fs::write(&self.output, &bytes).map_err(|error| Failure::io(&self.output, &error))?;
        if self.target.json {
            anstream::println!("{:#}", serde_json::json!({ "calibration": name, "bytes": bytes.len() }));
        } else {
            anstream::println!("Calibration {name}, {} bytes, written to {}", bytes.len(), self.output.display());
        }
        Ok(Answer::Yes)
    }
}
