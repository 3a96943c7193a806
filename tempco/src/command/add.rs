//! `tempco add model.toml EFFECT DATA -o better.toml`, or with `--expression TEXT` for EFFECT

use super::change::{Ladder, Request};
use crate::failure::{Answer, Failure};
use crate::terminal::say;
use clap::Args;
use trainer::train::EffectChoice;

/// Adds a physical effect to a model, retrains everything together, and shows how far the residual falls.
///
/// Exits 1 where it does not fall, or where the effect ends at the bound of what makes physical sense.
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
        let chosen = |effect| EffectChoice { channel: self.channel.clone(), ..effect };
        let Ladder { doubts, .. } = self.request.carry_out(|change, effect| change.with(chosen(effect)))?;
        if doubts.is_empty() {
            return Ok(Answer::Yes);
        }
        if !self.request.is_json() {
            let doubts: Vec<String> = doubts.iter().map(|doubt| format!("Doubtful: {doubt}.\n")).collect();
            let before = self.request.model().display();
            say!("{}Next:  go back to {before}, which is as it was, and try another effect", doubts.concat())?;
        }
        Ok(Answer::No)
    }
}
