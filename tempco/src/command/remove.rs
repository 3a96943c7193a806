//! `tempco remove model.toml EFFECT DATA -o simpler.toml`, or with `--expression TEXT` for EFFECT

use super::change::Request;
use crate::failure::{Answer, Failure};
use clap::Args;

/// Takes a physical effect out of a model and retrains the rest.
#[derive(Args)]
#[command(after_help = "Example:  tempco remove model.toml thermal-lag campaign.csv -o simpler.toml")]
pub struct Remove {
    #[command(flatten)]
    request: Request,
}

impl Remove {
    pub fn run(&self) -> Result<Answer, Failure> {
        self.request.carry_out(|change, effect| change.without(&effect))?;
        Ok(Answer::Yes)
    }
}
