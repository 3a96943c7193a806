//! `tempco add model.toml EFFECT DATA -o better.toml`

use super::change::{Change, ladder};
use crate::data::Data;
use crate::failure::{Answer, Failure};
use clap::Args;
use std::path::PathBuf;
use trainer::train::EffectChoice;

/// Adds a physical effect to a model, retrains everything together, and shows how far the residual falls.
#[derive(Args)]
#[command(after_help = "Example:  tempco add model.toml thermal-lag campaign.csv -o better.toml")]
pub struct Add {
    /// Model file
    model: PathBuf,

    /// Effect to add (`tempco effects` lists them)
    effect: String,

    #[command(flatten)]
    data: Data,

    /// The channel that the effect follows, where not its usual one
    #[arg(long, value_name = "COLUMN")]
    channel: Option<String>,

    /// Where to write the new model
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Add {
    pub fn run(&self) -> Result<Answer, Failure> {
        let change = Change::read(&self.model, &self.data)?;
        let mut effects = EffectChoice::of(&change.model);
        if effects.iter().any(|choice| choice.name == self.effect) {
            return Err(Failure::new(format_args!("the model has the effect `{}` already", self.effect)));
        }
        effects.push(EffectChoice { channel: self.channel.clone(), ..EffectChoice::named(&self.effect) });
        ladder(&change, &effects, &self.output, self.json)
    }
}
