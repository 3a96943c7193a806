//! `tempco simulate SCENARIO -o campaign.csv`

pub mod blind;
mod measured;

pub use measured::{scenario, simulate, written};

use crate::data::seeds;
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output};
use crate::terminal::say;
use clap::Args;
use firmware_sim::scenario::Scenario;
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
