//! `tempco workbench DATA`

use super::{First, Settings, serve};
use crate::command::demo::SEED;
use crate::data::{Data, Reading, seeds};
use crate::failure::{Answer, Failure};
use clap::Args;
use std::path::PathBuf;

/// Opens a page on this computer in which one sees where a model fails, why, and what to add.
#[derive(Args)]
#[command(after_help = "Example:  tempco workbench campaign.csv --open\n          tempco workbench --demo")]
pub struct Workbench {
    /// Campaign: CSV files, or folders of them; without it, one that hides an effect is simulated
    #[arg(value_name = "DATA")]
    files: Vec<PathBuf>,

    #[command(flatten)]
    reading: Reading,

    /// Simulates a campaign that hides an effect, for practice; a guide leads to it
    #[arg(long, conflicts_with = "files")]
    demo: bool,

    /// Seed of the simulated campaign, and of what it hides
    #[arg(long, default_value_t = SEED, value_parser = seeds())]
    seed: u64,

    /// Folder for what is made: models, calibrations, plans, uploaded files
    #[arg(short, long, value_name = "FOLDER", default_value = "tempco-workbench")]
    output: PathBuf,

    /// Port on 127.0.0.1; 0 takes any that is free
    #[arg(long, default_value_t = 0)]
    port: u16,

    /// Opens the page in the browser
    #[arg(long)]
    open: bool,
}

impl Workbench {
    pub fn run(&self) -> Result<Answer, Failure> {
        let first = if self.files.is_empty() {
            First::Demo { seed: self.seed }
        } else {
            First::Data(Data { files: self.files.clone(), reading: self.reading.clone() })
        };
        serve(Settings { folder: self.output.clone(), port: self.port, open: self.open, first })?;
        Ok(Answer::Yes)
    }
}
