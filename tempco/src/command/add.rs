//! `tempco add model.toml EFFECT DATA -o better.toml`, or with `--expression TEXT` for EFFECT

use super::change::Request;
use crate::failure::{Answer, Failure};
use clap::Args;
use trainer::train::EffectChoice;

/// Adds a physical effect to a model, retrains everything together, and shows how far the residual falls.
#[derive(Args)]
#[command(after_help = "Example:  tempco add model.toml thermal-lag campaign.csv -o better.toml
          tempco add model.toml --expression \"supply_v * temperature_rate\" campaign.csv -o b.toml")]
pub struct Add {
    #[command(flatten)]
    request: Request,

    /// The channel that the effect follows, where not its usual one
    #[arg(long, value_name = "COLUMN", conflicts_with = "expression")]
    channel: Option<String>,
}

impl Add {
    pub fn run(&self) -> Result<Answer, Failure> {
        self.request.carry_out(|change, effect| change.with(EffectChoice { channel: self.channel.clone(), ..effect }))
    }
}
