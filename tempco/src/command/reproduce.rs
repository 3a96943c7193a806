//! `tempco reproduce`: the paper's figures and tables, computed again.

mod campaigns;
mod claims;
mod evolution_plot;
mod extent;
mod json;
mod number;
mod rates_plot;
mod searches;
mod shortfalls;
mod sweep_plot;
mod tables;

use crate::failure::{Answer, Failure};
use crate::output::{Kind, make_folder};
use crate::terminal::say;
use campaigns::Judged;
use clap::Args;
use extent::Extent;
use std::path::PathBuf;
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

    #[command(flatten)]
    extent: Extent,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Reproduce {
    pub fn run(&self) -> Result<Answer, Failure> {
        make_folder(&self.extent.output)?;
        self.check()?;
        let all = self.figures == self.tables;
        let mut files = Vec::new();
        let mut trials = Vec::new();
        let mut judged = Vec::new();
        if all || self.figures {
            trials = searches::search(self.extent.seeds, self.extent.seed)?;
            self.draw(&mut files, "figure-3-schaffer.svg", &evolution_plot::evolution("Schaffer", &trials)?)?;
            self.draw(&mut files, "figure-4-rastrigin.svg", &evolution_plot::evolution("Rastrigin", &trials)?)?;
            self.draw(&mut files, "success-rates.svg", &rates_plot::rates(&trials)?)?;
            self.say(|| searches::text(&trials, self.extent.seed) + &claims::text(&trials))?;
        }
        if all || self.tables {
            judged = campaigns::judge(&self.extent, &mut files)?;
            self.draw(&mut files, "between-the-levels.svg", &sweep_plot::sweep(&judged)?)?;
            self.say(|| tables::text(&judged, &self.extent))?;
        }
        self.finish(&trials, &judged, &files)?;
        Ok(Answer::Yes)
    }

    fn say(&self, text: impl FnOnce() -> String) -> Result<(), Failure> {
        if self.json { Ok(()) } else { say!("{}", text()) }
    }

    fn finish(&self, trials: &[Trial], judged: &[Judged], files: &[PathBuf]) -> Result<(), Failure> {
        if self.json {
            return say!("{:#}", json::json(&self.extent, trials, judged, files));
        }
        let names: Vec<_> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        say!("Files in {}: {}", self.extent.output.display(), names.join(", "))
    }

    /// Writes a picture.
    fn draw(&self, files: &mut Vec<PathBuf>, name: &str, svg: &str) -> Result<(), Failure> {
        let path = self.extent.path(name);
        self.extent.place(name, Kind::Picture).write(svg.as_bytes())?;
        files.push(path);
        Ok(())
    }

    /// Every file that may be written, before hours of work.
    fn check(&self) -> Result<(), Failure> {
        let pictures =
            ["figure-3-schaffer.svg", "figure-4-rastrigin.svg", "success-rates.svg", "between-the-levels.svg"];
        pictures.iter().try_for_each(|name| self.extent.place(name, Kind::Picture).check())?;
        campaigns::files().try_for_each(|name| self.extent.place(&name, Kind::Campaign).check())
    }
}
