//! `tempco device rollback PORT`

use super::target::Target;
use crate::digits::digits;
use crate::failure::{Answer, Failure};
use crate::progress::spinner;
use crate::terminal::say;
use clap::Args;
use firmware_sim::link::LinkError;

/// Returns to the calibration that was stored before the one in use, which is erased.
///
/// Exit code 1 if there is none before.
#[derive(Args)]
#[command(after_help = "Example:  tempco device rollback /dev/ttyUSB0")]
pub struct Rollback {
    #[command(flatten)]
    target: Target,
}

impl Rollback {
    pub fn run(&self) -> Result<Answer, Failure> {
        let mut link = self.target.port.connect()?;
        let waiting = spinner("going back");
        let outcome = link.roll_back();
        waiting.finish_and_clear();
        let refusal = match outcome {
            Ok(()) => None,
            Err(LinkError::Refused(refusal)) => Some(refusal.to_string()),
            Err(error) => return Err(error.into()),
        };
        let name = link.state()?.provenance.map(|provenance| digits(&provenance));
        let shown = name.as_deref().unwrap_or("none");
        if self.target.json {
            say!("{:#}", serde_json::json!({ "calibration": name, "refusal": refusal }))?;
        } else if let Some(refusal) = &refusal {
            say!("The instrument refused: {refusal}. In use: {shown}")?;
        } else {
            say!("Back at calibration {shown}.")?;
        }
        Ok(if refusal.is_none() { Answer::Yes } else { Answer::No })
    }
}
