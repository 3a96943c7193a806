//! `tempco demo`: the whole path on a simulated campaign.

use super::train::train_with_bar;
use super::{export, simulate, verify};
use crate::failure::{Answer, Failure};
use crate::table::Table;
use clap::Args;
use firmware_sim::scenario::Scenario;
use std::path::{Path, PathBuf};
use trainer::campaign::{Campaign, HoldOut, ReadOptions, Split};
use trainer::compare::compare;
use trainer::noise::rms;
use trainer::train::{Backprop, Method, TrainSettings, Trained};

/// Shows the whole path: measurements, training, comparison, export, verification.
#[derive(Args)]
#[command(after_help = "Example:  tempco demo --output my-demo")]
pub struct Demo {
    /// Folder for the files
    #[arg(short, long, value_name = "FOLDER", default_value = "tempco-demo")]
    output: PathBuf,

    /// Seed of every random number
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Demo {
    pub fn run(&self) -> Result<Answer, Failure> {
        std::fs::create_dir_all(&self.output).map_err(|error| Failure::io(&self.output, &error))?;
        let data = self.output.join("campaign.csv");
        let floor_ug = self.measure(&data)?;
        let campaign = Campaign::read(std::slice::from_ref(&data), &ReadOptions::default())?;
        let split = campaign.split(&HoldOut::LastOfEachKind)?;
        let names: Vec<&str> = split.held_out.iter().map(|&index| campaign.runs[index].name.as_str()).collect();
        anstream::println!("   held out, never seen by any training: {}\n", names.join(", "));
        let trained = self.train(&campaign, &split, floor_ug)?;
        self.deliver(&trained, &campaign, &data)
    }

    fn measure(&self, data: &Path) -> Result<f64, Failure> {
        let scenario = Scenario::preset("clean").ok_or_else(|| Failure::new("no scenario named clean"))?;
        let recording = simulate::simulate(&scenario, self.seed)?;
        simulate::write(&recording, data)?;
        anstream::println!(
            "1. Measurements: {} rows in {} runs, {}",
            recording.rows(),
            recording.runs.len(),
            scenario.description
        );
        anstream::println!("   noise floor stated by the simulation: {:.2} µg", recording.noise_floor_ug());
        Ok(recording.noise_floor_ug())
    }

    /// Trains with every method and prints what each leaves on the held-out runs.
    fn train(&self, campaign: &Campaign, split: &Split, floor_ug: f64) -> Result<Trained, Failure> {
        let methods = [
            ("FA-BP (paper's comparison)", Method::Backprop(Backprop::standard())),
            ("IFA-BP (paper's method)", Method::Backprop(Backprop::improved())),
            ("second order (default)", Method::SecondOrder),
        ];
        let mut table = Table::new(["model", "held-out residual µg", "times the noise floor", "worst slope error ppm"]);
        let mut row = |name: &str, residual_ug: f64, slope: Option<f64>| {
            table.row([
                name.to_owned(),
                format!("{residual_ug:.2}"),
                format!("{:.2}", residual_ug / floor_ug),
                slope.map_or_else(|| "–".to_owned(), |worst| format!("{worst:.0}")),
            ]);
        };
        let mut last = None;
        for (name, method) in methods {
            let settings = TrainSettings { method, ..TrainSettings::new(self.seed) };
            let trained = train_with_bar(campaign, split, &settings, name)?;
            let comparison = compare(&trained.model, campaign)?;
            if last.is_none() {
                row(
                    "none: a line through the raw frequency",
                    held_out_ug(campaign, split, |run| trained.raw_g(run)),
                    None,
                );
                let polynomial = held_out_ug(campaign, split, |run| trained.baseline.residuals_g(run));
                row("polynomial Δf²·T³", polynomial, None);
            }
            row(name, comparison.residual_ug, comparison.sensitivity_ppm.map(|sensitivity| sensitivity.worst));
            last = Some(trained);
        }
        anstream::println!("2. Models, 30 restarts each:\n{table}");
        last.ok_or_else(|| Failure::new("no method was trained"))
    }

    fn deliver(&self, trained: &Trained, campaign: &Campaign, data: &Path) -> Result<Answer, Failure> {
        let (model, bin, hex) =
            (self.output.join("model.toml"), self.output.join("calibration.bin"), self.output.join("calibration.hex"));
        trained.model.write(&model)?;
        let bytes = trained.model.to_bytes()?;
        export::write(&bin, &bytes)?;
        let address = export::write(&hex, &bytes)?;
        anstream::println!("3. Calibration exported: {} bytes{address}", bytes.len());
        let parity = verify::verify(&trained.model.to_blob()?, campaign)?;
        anstream::println!("4. Virtual instrument, over its own wire: {parity}\n");
        anstream::println!(
            "The files are in {}: model.toml, calibration.bin, calibration.hex, campaign.csv",
            self.output.display()
        );
        anstream::println!("Look closer:  tempco compare {} {}", model.display(), data.display());
        anstream::println!("Repeat:       {}", verify::command_line(&model, data));
        Ok(if parity.identical == parity.samples { Answer::Yes } else { Answer::No })
    }
}

fn held_out_ug(campaign: &Campaign, split: &Split, residuals_g: impl Fn(&trainer::campaign::Run) -> Vec<f64>) -> f64 {
    let residuals: Vec<f64> = split.held_out.iter().flat_map(|&index| residuals_g(&campaign.runs[index])).collect();
    rms(&residuals) * 1e6
}
