//! `tempco simulate SCENARIO -o campaign.csv`

pub mod blind;

use crate::failure::{Answer, Failure};
use crate::progress::bar;
use clap::Args;
use firmware_sim::recording::Recording;
use firmware_sim::scenario::Scenario;
use firmware_sim::twin;
use std::fs::File;
use std::io::BufWriter;
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

    /// Seed of every random number
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Where to write the campaign
    #[arg(short, long, value_name = "FILE", default_value = "campaign.csv")]
    output: PathBuf,

    /// Prints the scenario's text instead of carrying it out: a start for one's own
    #[arg(long)]
    print: bool,

    #[command(flatten)]
    blind: blind::Blind,
}

impl Simulate {
    pub fn run(&self) -> Result<Answer, Failure> {
        let Some(name) = &self.scenario else {
            list();
            return Ok(Answer::Yes);
        };
        let scenario = scenario(name)?;
        if self.print {
            anstream::println!("{}", scenario.to_toml());
            return Ok(Answer::Yes);
        }
        if self.blind.blind {
            anstream::println!("{}", self.blind.measure(&scenario, self.seed, &self.output)?);
            return Ok(Answer::Yes);
        }
        let recording = simulate(&scenario, self.seed)?;
        write(&recording, &self.output)?;
        anstream::println!(
            "{} rows in {} runs written to {}; noise floor {:.2} µg",
            recording.rows(),
            recording.runs.len(),
            self.output.display(),
            recording.noise_floor_ug()
        );
        Ok(Answer::Yes)
    }
}

fn list() {
    for name in Scenario::preset_names() {
        let description = Scenario::preset(name).map(|scenario| scenario.description).unwrap_or_default();
        anstream::println!("{name:14} {description}");
    }
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
    let recording = twin::simulate(scenario, seed, &mut |done| {
        bar.set_position((done * 100.0) as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    recording.map_err(Failure::new)
}

/// Writes the campaign as one CSV file.
pub fn write(recording: &Recording, path: &Path) -> Result<(), Failure> {
    let io = |error: std::io::Error| Failure::io(path, &error);
    let mut file = BufWriter::new(File::create(path).map_err(io)?);
    recording.write_csv(&mut file).map_err(io)
}
