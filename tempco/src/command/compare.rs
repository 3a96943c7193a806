//! `tempco compare MODEL DATA`

use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::render;
use clap::Args;
use std::path::PathBuf;
use trainer::compare::compare;
use trainer::model::Model;

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

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub fn run(&self) -> Result<Answer, Failure> {
        let model = Model::read(&self.model)?;
        let comparison = compare(&model, &self.data.read()?)?;
        if self.json {
            anstream::println!("{:#}", serde_json::json!(comparison));
        } else {
            anstream::println!("{}", render::comparison(&comparison));
        }
        let exceeded = self.fail_above.is_some_and(|limit_ug| comparison.residual_ug > limit_ug);
        Ok(if exceeded { Answer::No } else { Answer::Yes })
    }
}
