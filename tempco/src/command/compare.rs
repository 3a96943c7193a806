//! `tempco compare MODEL DATA`

use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::render;
use crate::report::html;
use clap::Args;
use std::path::{Path, PathBuf};
use trainer::campaign::{Campaign, HoldOut};
use trainer::compare::compare;
use trainer::cross_validation::{CrossValidation, cross_validate};
use trainer::model::Model;
use trainer::report::report;
use trainer::train::{EffectChoice, TrainSettings};

/// Compares a model with measurements, run by run, in the device's own arithmetic.
#[derive(Args)]
#[command(after_help = "Example:  tempco compare model.toml campaign.csv --fail-above 8")]
pub struct Compare {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    data: Data,

    /// Exit with 1 if the residual exceeds this, µg
    #[arg(long, value_name = "UG")]
    fail_above: Option<f64>,

    /// Trains again without each inner level and temperature, and says how well the model holds there
    #[arg(long)]
    cross_validate: bool,

    /// Writes a report for people as well: one HTML file that needs nothing else
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub fn run(&self) -> Result<Answer, Failure> {
        let model = Model::read(&self.model)?;
        let campaign = self.data.read()?;
        let comparison = compare(&model, &campaign)?;
        let validation = if self.cross_validate { Some(validate(&model, &campaign)?) } else { None };
        if self.json {
            let mut value = serde_json::json!(comparison);
            value["cross_validation"] = serde_json::json!(validation);
            anstream::println!("{value:#}");
        } else {
            anstream::println!("{}", render::comparison(&comparison));
            if let Some(validation) = &validation {
                anstream::println!("{}", render::cross_validation(validation));
            }
        }
        if let Some(path) = &self.report {
            write_report(path, &model, &campaign)?;
        }
        let exceeded = self.fail_above.is_some_and(|limit_ug| comparison.residual_ug > limit_ug);
        Ok(if exceeded { Answer::No } else { Answer::Yes })
    }
}

fn write_report(path: &Path, model: &Model, campaign: &Campaign) -> Result<(), Failure> {
    let html = html(&report(model, campaign)?).map_err(Failure::new)?;
    std::fs::write(path, html).map_err(|error| Failure::io(path, &error))
}

/// Fewer restarts than a training: dozens of trainings are made, and the median restart is as good for this.
const RESTARTS: usize = 4;

fn validate(model: &Model, campaign: &Campaign) -> Result<CrossValidation, Failure> {
    let settings = TrainSettings {
        restarts: RESTARTS,
        effects: EffectChoice::of(model),
        ..TrainSettings::new(model.provenance.seed)
    };
    Ok(cross_validate(campaign, &campaign.split(&HoldOut::LastOfEachKind)?, &settings)?)
}
