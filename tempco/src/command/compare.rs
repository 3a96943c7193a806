//! `tempco compare MODEL DATA`

use super::diagnose::diagnosed;
use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output};
use crate::progress::Restarts;
use crate::render;
use crate::report::html;
use crate::terminal::say;
use clap::Args;
use std::path::PathBuf;
use trainer::campaign::Campaign;
use trainer::compare::compare;
use trainer::cross_validation::{CrossValidation, cross_validate};
use trainer::ladder::{Rung, ladder};
use trainer::model::Model;
use trainer::report::{DataFile, Report, report};
use trainer::retrain;
use trainer::train::TrainSettings;

/// Compares a model with measurements, run by run, in the device's own arithmetic.
#[derive(Args)]
#[command(after_help = "Example:  tempco compare model.toml campaign.csv --fail-above 8
          tempco compare model.toml campaign.csv --report report.html --diagnose")]
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

    #[command(flatten)]
    force: Force,

    /// Diagnoses for the report which effects are missing
    #[arg(long, requires = "report")]
    diagnose: bool,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub fn run(&self) -> Result<Answer, Failure> {
        let inputs = || self.data.files.iter().chain([&self.model]);
        let report =
            self.report.as_ref().map(|path| Output::file(path, Kind::Report, "--report", self.force).reading(inputs()));
        report.as_ref().map_or(Ok(()), Output::check)?;
        let model = Model::read(&self.model)?;
        let campaign = self.data.read_for(&model)?;
        let comparison = compare(&model, &campaign)?;
        let validation = if self.cross_validate { Some(validate(&model, &campaign)?) } else { None };
        if self.json {
            let mut value = serde_json::json!(comparison);
            value["cross_validation"] = serde_json::json!(validation);
            say!("{value:#}")?;
        } else {
            say!("{}", render::comparison(&comparison))?;
            if let Some(validation) = &validation {
                say!("{}", render::cross_validation(validation))?;
            }
        }
        if let Some((path, output)) = self.report.as_ref().zip(report) {
            let html = html(&self.report(&model, &campaign)?).map_err(Failure::new)?;
            output.write(html.as_bytes())?;
            if !self.json {
                say!("Report written to {}", path.display())?;
            }
        }
        let exceeded = self.fail_above.is_some_and(|limit_ug| comparison.residual_ug > limit_ug);
        Ok(if exceeded { Answer::No } else { Answer::Yes })
    }

    fn report(&self, model: &Model, campaign: &Campaign) -> Result<Report, Failure> {
        let mut report = report(model, campaign)?;
        report.origin.files = DataFile::all_of(campaign).map_err(Failure::new)?;
        if report.origin.same_campaign && !model.effects.is_empty() {
            report.ladder = rungs(model, campaign)?;
        }
        if self.diagnose {
            report.diagnosis = Some(diagnosed(model, campaign)?);
        }
        Ok(report)
    }
}

/// What each effect of the model is worth. The lower rungs are trained again, as `add` did.
fn rungs(model: &Model, campaign: &Campaign) -> Result<Vec<Rung>, Failure> {
    let settings = retrain::settings(model);
    let progress = Restarts::new(settings.restarts.saturating_mul(model.effects.len()), "ladder");
    Ok(ladder(model, campaign, &retrain::split(model, campaign)?, &settings, &progress)?)
}

/// Fewer restarts than a training: dozens of trainings are made, and the median restart is as good for this.
const RESTARTS: usize = 4;

fn validate(model: &Model, campaign: &Campaign) -> Result<CrossValidation, Failure> {
    let settings = TrainSettings { restarts: RESTARTS, ..retrain::settings(model) };
    Ok(cross_validate(campaign, &retrain::split(model, campaign)?, &settings)?)
}
