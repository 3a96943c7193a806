//! `tempco simulate SCENARIO -o campaign.csv`

pub mod blind;

use crate::data::seeds;
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output, with_mark};
use crate::progress::bar;
use crate::terminal::say;
use clap::Args;
use firmware_sim::recording::Recording;
use firmware_sim::scenario::Scenario;
use firmware_sim::simulation;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Measures a campaign on the physics twin: a laboratory for those who have none.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco simulate clean --seed 7 -o campaign.csv\n          tempco simulate rich --blind --seed 7 -o campaign.csv"
)]
pub struct Simulate {
    /// Built-in scenario, or a scenario file; without it the built-in ones are listed
    scenario: Option<String>,

    /// Seed of every random number, up to 2⁶³ − 1
    #[arg(long, default_value_t = 1, value_parser = seeds())]
    seed: u64,

    /// Where to write the campaign
    #[arg(short, long, value_name = "FILE", default_value = "campaign.csv")]
    output: PathBuf,

    #[command(flatten)]
    force: Force,

    /// Prints the scenario's text instead of carrying it out: a start for one's own
    #[arg(long)]
    print: bool,

    #[command(flatten)]
    blind: blind::Blind,
}

impl Simulate {
    pub fn run(&self) -> Result<Answer, Failure> {
        let Some(name) = &self.scenario else {
            list()?;
            return Ok(Answer::Yes);
        };
        let scenario = scenario(name)?;
        if self.print {
            say!("{}", scenario.to_toml())?;
            return Ok(Answer::Yes);
        }
        let output = |path: &Path, kind| Output::file(path, kind, "-o", self.force).reading([&PathBuf::from(name)]);
        if self.blind.blind {
            say!("{}", self.blind.measure(&scenario, self.seed, &self.output, &output)?)?;
            return Ok(Answer::Yes);
        }
        let output = output(&self.output, Kind::Campaign);
        output.check()?;
        let recording = simulate(&scenario, self.seed)?;
        output.write(&written(&recording)?)?;
        say!(
            "{} rows in {} runs written to {}; noise floor {:.2} µg",
            recording.rows(),
            recording.runs.len(),
            self.output.display(),
            recording.noise_floor_ug()
        )?;
        Ok(Answer::Yes)
    }
}

fn list() -> Result<(), Failure> {
    for name in Scenario::preset_names() {
        let description = Scenario::preset(name).map(|scenario| scenario.description).unwrap_or_default();
        say!("{name:14} {description}")?;
    }
    Ok(())
}

/// A built-in scenario by name, or a file.
pub fn scenario(name: &str) -> Result<Scenario, Failure> {
    if let Some(scenario) = Scenario::preset(name) {
        return Ok(scenario);
    }
    let text = std::fs::read_to_string(name).map_err(|error| {
        Failure::new(format_args!("{name}: {error}"))
            .help("`tempco simulate` lists the built-in scenarios; anything else must be a scenario file")
    })?;
    Scenario::from_toml(&text).map_err(|error| Failure::new(format_args!("{name}: {error}")))
}

/// Carries out a scenario with a progress bar.
pub fn simulate(scenario: &Scenario, seed: u64) -> Result<Recording, Failure> {
    let bar = bar(100, "measuring");
    let recording = simulation::simulate(scenario, seed, &mut |done| {
        bar.set_position((done * 100.0) as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    recording.map_err(Failure::new)
}

/// The campaign as one CSV file, with the mark by which tempco knows it again.
pub fn written(recording: &Recording) -> Result<Vec<u8>, Failure> {
    let mut table = Vec::new();
    recording.write_csv(&mut table).map_err(Failure::new)?;
    Ok(with_mark(Kind::Campaign, &table))
}
