//! `tempco train DATA -o model.toml`

use crate::data::{Data, HeldOut};
use crate::failure::{Answer, Failure};
use crate::progress::Restarts;
use crate::render;
use crate::table::Table;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use trainer::campaign::{Campaign, Demand, Split};
use trainer::compare::{Comparison, compare};
use trainer::train::{Backprop, Method, TrainSettings, Trained, train};

/// Trains a compensation model from a campaign and compares it with the runs that were held out.
#[derive(Args)]
#[command(after_help = "Example:  tempco train campaign.csv -o model.toml --hold-out full-4,zero-3")]
pub struct Train {
    #[command(flatten)]
    data: Data,

    #[command(flatten)]
    held_out: HeldOut,

    #[command(flatten)]
    training: Training,

    /// Where to write the model
    #[arg(short, long, value_name = "FILE", default_value = "model.toml")]
    output: PathBuf,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// How to train.
#[derive(Args)]
pub struct Training {
    /// Training method
    #[arg(long, value_enum, default_value_t = MethodName::SecondOrder)]
    method: MethodName,

    /// Trainings from different starts; the best is kept
    #[arg(long, default_value_t = 30)]
    restarts: usize,

    /// Seed of every random number
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Scale factor in signal units per reference unit, for a campaign whose reference never varies
    #[arg(long, value_name = "HZ_PER_G")]
    scale_factor: Option<f64>,

    /// Serial number of the sensor; the device then refuses the calibration of another one
    #[arg(long, default_value = "")]
    serial: String,
}

/// Training methods by name.
#[derive(Clone, Copy, ValueEnum)]
pub enum MethodName {
    /// Variable projection and Levenberg–Marquardt, slope held to the measured scale factor
    SecondOrder,
    /// The paper's gradient descent from a standard firefly swarm
    FaBp,
    /// The paper's gradient descent from an improved firefly swarm
    IfaBp,
}

impl MethodName {
    pub fn method(self) -> Method {
        match self {
            Self::SecondOrder => Method::SecondOrder,
            Self::FaBp => Method::Backprop(Backprop::standard()),
            Self::IfaBp => Method::Backprop(Backprop::improved()),
        }
    }
}

impl Training {
    pub fn settings(&self) -> TrainSettings {
        TrainSettings {
            method: self.method.method(),
            restarts: self.restarts,
            scale_factor_hz_per_g: self.scale_factor,
            serial: self.serial.clone(),
            ..TrainSettings::new(self.seed)
        }
    }
}

/// Rows below which 41 weights mean nothing.
const ROWS_MIN: usize = 100;

impl Train {
    pub fn run(&self) -> Result<Answer, Failure> {
        let campaign = self.data.read()?;
        campaign.check_trainable(&Demand {
            rows_min: ROWS_MIN,
            scale_factor_stated: self.training.scale_factor.is_some(),
            one_run_will_do: matches!(self.held_out.choice(), trainer::campaign::HoldOut::None),
        })?;
        let split = campaign.split(&self.held_out.choice())?;
        let trained = train_with_bar(&campaign, &split, &self.training.settings(), "training")?;
        trained.model.write(&self.output)?;
        let comparison = compare(&trained.model, &campaign)?;
        if self.json {
            anstream::println!("{}", json(&comparison, &trained));
        } else {
            anstream::println!("{}", text(&campaign, &split, &trained, &comparison));
            anstream::println!("Model written to {}", self.output.display());
        }
        Ok(Answer::Yes)
    }
}

/// Trains with a progress bar.
pub fn train_with_bar(
    campaign: &Campaign,
    split: &Split,
    settings: &TrainSettings,
    what: &str,
) -> Result<Trained, Failure> {
    let progress = Restarts::new(settings.restarts, what);
    Ok(train(campaign, split, settings, &progress)?)
}

fn text(campaign: &Campaign, split: &Split, trained: &Trained, comparison: &Comparison) -> String {
    let each = trained.restarts.iter().map(|restart| format!("{:.2}", restart.residual_g * 1e6));
    let each = each.collect::<Vec<_>>().join(" ");
    format!(
        "{} rows in {} runs; {}.\n{}  in order, µg: {each}\n\n{}",
        campaign.row_count(),
        campaign.runs.len(),
        split.basis,
        restarts(trained),
        render::comparison(comparison)
    )
}

fn restarts(trained: &Trained) -> Table {
    let mut residuals: Vec<f64> = trained.restarts.iter().map(|restart| restart.residual_g * 1e6).collect();
    residuals.sort_by(f64::total_cmp);
    let at = |part: usize| residuals.get((residuals.len() - 1) * part / 4).copied().unwrap_or_default();
    let converged = trained.restarts.iter().filter(|restart| restart.converged).count();
    let mut table = Table::new(["restarts", "converged", "best µg", "quartile", "median", "quartile", "worst"]);
    table.row([
        residuals.len().to_string(),
        converged.to_string(),
        format!("{:.3}", at(0)),
        format!("{:.3}", at(1)),
        format!("{:.3}", at(2)),
        format!("{:.3}", at(3)),
        format!("{:.3}", at(4)),
    ]);
    table
}

fn json(comparison: &Comparison, trained: &Trained) -> String {
    let restarts: Vec<_> = trained
        .restarts
        .iter()
        .map(|restart| {
            serde_json::json!({
                "residual_ug": restart.residual_g * 1e6,
                "iterations": restart.iterations,
                "converged": restart.converged,
            })
        })
        .collect();
    let mut value = serde_json::json!(comparison);
    value["restarts"] = restarts.into();
    format!("{value:#}")
}
