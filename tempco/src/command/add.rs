//! `tempco add model.toml EFFECT DATA -o better.toml`, or with `--expression TEXT` for EFFECT

use super::change::{Change, ladder};
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output};
use crate::subject::Subject;
use clap::Args;
use std::path::PathBuf;
use trainer::model::Model;
use trainer::train::EffectChoice;

/// Adds a physical effect to a model, retrains everything together, and shows how far the residual falls.
#[derive(Args)]
#[command(after_help = "Example:  tempco add model.toml thermal-lag campaign.csv -o better.toml
          tempco add model.toml --expression \"supply_v * temperature_rate\" campaign.csv -o b.toml")]
pub struct Add {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    subject: Subject,

    /// The channel that the effect follows, where not its usual one
    #[arg(long, value_name = "COLUMN", conflicts_with = "expression")]
    channel: Option<String>,

    /// Where to write the new model
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    #[command(flatten)]
    force: Force,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Add {
    pub fn run(&self) -> Result<Answer, Failure> {
        let output = Output::file(&self.output, Kind::Model, "-o", self.force);
        let output = output.reading(self.subject.files().iter().chain([&self.model]));
        output.check()?;
        let model = Model::read(&self.model)?;
        let campaign = self.subject.read_for(&model)?;
        let change = Change::of(&model, &campaign)?.scaled(self.subject.scale_factor);
        let effects = change.with(EffectChoice { channel: self.channel.clone(), ..self.subject.effect() })?;
        ladder(&change, &effects, &output, self.json)
    }
}
