//! `tempco device identify PORT`

use super::target::Target;
use crate::failure::{Answer, Failure};
use crate::terminal::say;
use clap::Args;

/// Asks an instrument who it is.
#[derive(Args)]
#[command(after_help = "Example:  tempco device identify /dev/ttyUSB0")]
pub struct Identify {
    #[command(flatten)]
    target: Target,
}

impl Identify {
    pub fn run(&self) -> Result<Answer, Failure> {
        let identity = self.target.port.connect()?.identify()?;
        if self.target.json {
            let answer = serde_json::json!({
                "serial": identity.serial.as_str(), "blob_layout": identity.blob_layout, "effects": identity.effects,
            });
            say!("{answer:#}")?;
        } else {
            let serial = if identity.serial.is_empty() { "without a serial number" } else { identity.serial.as_str() };
            say!(
                "Instrument {serial}: reads calibrations of layout {}, knows effects up to number {}",
                identity.blob_layout,
                identity.effects
            )?;
        }
        Ok(Answer::Yes)
    }
}
