//! `tempco reproduce`: the paper's figures and tables, computed again.

mod campaigns;
mod claims;
mod evolution_plot;
mod json;
mod rates_plot;
mod searches;
mod shortfalls;
mod sweep_plot;
mod tables;

use crate::failure::{Answer, Failure};
use campaigns::Judged;
use clap::Args;
use std::path::{Path, PathBuf};
use trainer::reproduction::trial::Trial;

/// Computes the figures and tables of Huang et al. (Micromachines 2022, 13, 1054) again, and counts what they claim.
///
/// Figures 3 and 4: the firefly algorithms FA and IFA on two test functions, over many seeds and on stated domains.
/// Tables 1 and 2: FA-BP, IFA-BP and the default on a simulated campaign that has the paper's raw figures.
#[derive(Args)]
#[command(after_help = "Example:  tempco reproduce --figures --seeds 1000 -o my-reproduction")]
pub struct Reproduce {
    /// Only the figures
    #[arg(long)]
    figures: bool,

    /// Only the tables
    #[arg(long)]
    tables: bool,

    /// Seeds of every search on a test function
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,

    /// Trainings from different starts; the paper makes 30
    #[arg(long, value_name = "N", default_value_t = 30)]
    restarts: usize,

    /// Passes of a gradient descent; the paper doesn't say
    #[arg(long, value_name = "N", default_value_t = 30_000)]
    passes: usize,

    /// Seed of every random number
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Folder for pictures and campaigns
    #[arg(short, long, value_name = "FOLDER", default_value = "tempco-reproduction")]
    output: PathBuf,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Reproduce {
    pub fn run(&self) -> Result<Answer, Failure> {
        std::fs::create_dir_all(&self.output).map_err(|error| Failure::io(&self.output, &error))?;
        let all = self.figures == self.tables;
        let mut files = Vec::new();
        let mut trials = Vec::new();
        let mut judged = Vec::new();
        if all || self.figures {
            trials = searches::search(self.seeds, self.seed)?;
            self.draw(&mut files, "figure-3-schaffer.svg", evolution_plot::evolution("Schaffer", &trials)?)?;
            self.draw(&mut files, "figure-4-rastrigin.svg", evolution_plot::evolution("Rastrigin", &trials)?)?;
            self.draw(&mut files, "success-rates.svg", rates_plot::rates(&trials)?)?;
            self.say(|| searches::text(&trials, self.seed) + &claims::text(&trials));
        }
        if all || self.tables {
            judged = campaigns::judge(self, &mut files)?;
            self.draw(&mut files, "between-the-levels.svg", sweep_plot::sweep(&judged)?)?;
            self.say(|| tables::text(&judged, self));
        }
        self.finish(&trials, &judged, &files);
        Ok(Answer::Yes)
    }

    fn say(&self, text: impl FnOnce() -> String) {
        if !self.json {
            anstream::println!("{}", text());
        }
    }

    fn finish(&self, trials: &[Trial], judged: &[Judged], files: &[PathBuf]) {
        if self.json {
            anstream::println!("{:#}", json::json(self, trials, judged, files));
            return;
        }
        let names: Vec<_> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        anstream::println!("Files in {}: {}", self.output.display(), names.join(", "));
    }

    /// Writes a picture.
    fn draw(&self, files: &mut Vec<PathBuf>, name: &str, svg: String) -> Result<(), Failure> {
        let path = self.path(name);
        std::fs::write(&path, svg).map_err(|error| Failure::io(&path, &error))?;
        files.push(path);
        Ok(())
    }

    fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.output.join(name)
    }
}
