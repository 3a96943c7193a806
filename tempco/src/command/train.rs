//! `tempco train DATA -o model.toml`

use crate::data::{Data, HeldOut, restarts as restart_counts, seeds};
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output};
use crate::progress::Restarts;
use crate::render;
use crate::shell::option;
use crate::table::Table;
use crate::terminal::say;
use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use trainer::campaign::{Campaign, Demand, HoldOut, Run, Split};
use trainer::compare::{Comparison, compare};
use trainer::noise::rms;
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

    #[command(flatten)]
    force: Force,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// How to train.
#[derive(Args, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Training {
    /// Training method
    #[arg(long, value_enum, default_value_t = MethodName::SecondOrder)]
    method: MethodName,

    /// Trainings from different starts, 1 to 10000; the best is kept
    #[arg(long, default_value_t = RESTARTS, value_parser = restart_counts())]
    restarts: usize,

    /// Seed of every random number, up to 2⁶³ − 1
    #[arg(long, default_value_t = TRAINING_SEED, value_parser = seeds())]
    seed: u64,

    /// Scale factor in signal units per reference unit, for a campaign whose reference never varies
    #[arg(long, value_name = "HZ_PER_G", allow_negative_numbers = true)]
    scale_factor: Option<f64>,

    /// Serial number of the sensor; the device then refuses the calibration of another one
    #[arg(long, default_value = "")]
    serial: String,
}

/// Training methods by name.
#[derive(Clone, Copy, Deserialize, PartialEq, Eq, ValueEnum)]
#[serde(rename_all = "kebab-case")]
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

/// As many as the paper makes.
const RESTARTS: usize = 30;
const TRAINING_SEED: u64 = 1;

impl Default for Training {
    fn default() -> Self {
        let (method, serial) = (MethodName::SecondOrder, String::new());
        Self { method, restarts: RESTARTS, seed: TRAINING_SEED, scale_factor: None, serial }
    }
}

impl Training {
    /// The options that differ from the usual, as they are typed.
    pub fn words(&self) -> impl Iterator<Item = String> {
        let usual = Self::default();
        [
            (self.method != usual.method).then(|| format!("--method {}", self.method.method().name())),
            (self.restarts != usual.restarts).then(|| format!("--restarts {}", self.restarts)),
            (self.seed != usual.seed).then(|| format!("--seed {}", self.seed)),
            self.scale_factor.map(|hz_per_g| option("--scale-factor", &hz_per_g.to_string())),
            (!self.serial.is_empty()).then(|| option("--serial", &self.serial)),
        ]
        .into_iter()
        .flatten()
    }

    /// What a model of it is called.
    pub fn title(&self) -> String {
        match self.method {
            MethodName::SecondOrder => "network alone".to_owned(),
            other => format!("network, {}", other.method().name()),
        }
    }

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
        let output = Output::file(&self.output, Kind::Model, "-o", self.force).reading(&self.data.files);
        output.check()?;
        let settings = self.training.settings();
        settings.check()?;
        let campaign = self.data.read()?;
        let split = split(&campaign, &self.held_out.choice(&campaign), &settings)?;
        let trained = train_with_bar(&campaign, &split, &settings, "training")?;
        output.write(trained.model.to_text().as_bytes())?;
        let comparison = compare(&trained.model, &campaign)?;
        if self.json {
            say!("{}", json(&comparison, &trained))?;
        } else {
            say!("{}", text(&campaign, &split, &trained, &comparison))?;
            say!("Model written to {}", self.output.display())?;
        }
        Ok(Answer::Yes)
    }
}

/// The split, of a campaign that can be trained on at all.
pub fn split(campaign: &Campaign, hold_out: &HoldOut, settings: &TrainSettings) -> Result<Split, Failure> {
    campaign.check_trainable(&Demand {
        rows_min: ROWS_MIN,
        scale_factor_stated: settings.scale_factor_hz_per_g.is_some(),
        one_run_will_do: matches!(hold_out, HoldOut::None),
    })?;
    Ok(campaign.split(hold_out)?)
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

/// What a simpler model leaves on the held-out runs, or on the training runs where none is held out.
#[derive(Clone, Debug, Serialize)]
pub struct Simpler {
    pub model: &'static str,
    pub residual_ug: f64,
}

impl Simpler {
    pub fn all(trained: &Trained, campaign: &Campaign, split: &Split) -> Vec<Self> {
        let judges = if split.held_out.is_empty() { &split.training } else { &split.held_out };
        let runs: Vec<&Run> = judges.iter().filter_map(|&index| campaign.runs.get(index)).collect();
        let raw: Vec<f64> = runs.iter().flat_map(|run| trained.raw_g(run)).collect();
        let polynomial: Vec<f64> = runs.iter().flat_map(|run| trained.baseline.residuals_g(run)).collect();
        vec![
            Self { model: "a line through the raw frequency", residual_ug: rms(&raw) * 1e6 },
            Self { model: "polynomial Δf²·T³", residual_ug: rms(&polynomial) * 1e6 },
        ]
    }
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
