//! `tempco remove model.toml EFFECT DATA -o simpler.toml`, or with `--expression TEXT` for EFFECT

use super::change::{Change, ladder};
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output};
use crate::subject::Subject;
use clap::Args;
use std::path::PathBuf;
use trainer::model::Model;

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

    #[command(flatten)]
    force: Force,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Remove {
    pub fn run(&self) -> Result<Answer, Failure> {
        let output = Output::file(&self.output, Kind::Model, "-o", self.force);
        let output = output.reading(self.subject.files().iter().chain([&self.model]));
        output.check()?;
        let model = Model::read(&self.model)?;
        let campaign = self.subject.read_for(&model)?;
        let change = Change::of(&model, &campaign)?.scaled(self.subject.scale_factor);
        let effects = change.without(&self.subject.effect())?;
        ladder(&change, &effects, &output, self.json)
    }
}
