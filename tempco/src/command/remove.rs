//! `tempco remove model.toml EFFECT DATA -o simpler.toml`, or with `--expression TEXT` for EFFECT

use super::change::{Change, ladder};
use crate::failure::{Answer, Failure};
use crate::subject::Subject;
use clap::Args;
use std::path::PathBuf;
use trainer::train::EffectChoice;

/// Takes a physical effect out of a model and retrains the rest.
#[derive(Args)]
#[command(after_help = "Example:  tempco remove model.toml thermal-lag campaign.csv -o simpler.toml")]
pub struct Remove {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    subject: Subject,

    /// Where to write the new model
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Remove {
    pub fn run(&self) -> Result<Answer, Failure> {
        let change = Change::read(&self.model, &self.subject)?;
        let mut effects = EffectChoice::of(&change.model);
        let before = effects.len();
        let unwanted = self.subject.effect();
        effects.retain(|choice| !choice.is_same(&unwanted));
        if effects.len() == before {
            let names: Vec<&str> = effects.iter().map(EffectChoice::title).collect();
            return Err(Failure::new(format_args!("the model has no effect `{}`", unwanted.title())).help(
                format_args!("it has: {}", if names.is_empty() { "none".to_owned() } else { names.join(", ") }),
            ));
        }
        ladder(&change, &effects, &self.output, self.json)
    }
}
