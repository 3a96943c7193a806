//! How much is computed again, and where it is written.

use crate::data::{restarts, seeds};
use crate::output::{Force, Kind, Output};
use clap::Args;
use clap::builder::RangedU64ValueParser;
use std::path::{Path, PathBuf};

/// How much, and where.
#[derive(Args)]
pub struct Extent {
    /// Seeds of every search on a test function, 1 to 1000000
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub seeds: u64,

    /// Trainings from different starts, 1 to 10000; the paper makes 30
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = restarts())]
    pub restarts: usize,

    /// Passes of a gradient descent, up to 10000000; the paper doesn't say
    #[arg(long, value_name = "N", default_value_t = 30_000, value_parser = RangedU64ValueParser::<usize>::new().range(1..=10_000_000))]
    pub passes: usize,

    /// Seed of every random number, up to 2⁶³ − 1
    #[arg(long, default_value_t = 1, value_parser = seeds())]
    pub seed: u64,

    /// Folder for pictures and campaigns
    #[arg(short, long, value_name = "FOLDER", default_value = "tempco-reproduction")]
    pub output: PathBuf,

    #[command(flatten)]
    force: Force,
}

impl Extent {
    /// Where a file of this name is written.
    pub fn place(&self, name: &str, kind: Kind) -> Output {
        Output::in_folder(&self.path(name), kind, "-o", self.force)
    }

    /// Its path.
    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.output.join(name)
    }
}
