//! `tempco diagnose MODEL DATA`

use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::progress::spinner;
use crate::render::diagnosis;
use crate::shell;
use crate::terminal::say;
use clap::Args;
use std::path::{Path, PathBuf};
use trainer::campaign::Campaign;
use trainer::diagnose::{Diagnosis, Verdict, diagnose};
use trainer::model::Model;
use trainer::progress::Quiet;

/// Says which physical effects a model lacks, how sure that is, and what the measurements can't tell.
#[derive(Args)]
#[command(after_help = "Example:  tempco diagnose model.toml campaign.csv")]
pub struct Diagnose {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    data: Data,

    /// Exit with 1 if anything is missing, named or not
    #[arg(long)]
    fail_if_missing: bool,

    /// Lists every effect that was judged, and what came of it
    #[arg(long)]
    all: bool,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Diagnose {
    pub fn run(&self) -> Result<Answer, Failure> {
        let model = Model::read(&self.model)?;
        let diagnosis = diagnosed(&model, &self.data.read_for(&model)?)?;
        if self.json {
            say!("{:#}", serde_json::json!(diagnosis))?;
        } else {
            say!("{}", diagnosis::text(&diagnosis, self.all))?;
            say!("Next:  {}", next(&diagnosis, &self.model, &self.data.command_line()))?;
        }
        let missing = diagnosis.verdict != Verdict::NothingMissing;
        Ok(if self.fail_if_missing && missing { Answer::No } else { Answer::Yes })
    }
}

/// Diagnoses, and shows that it is at work.
pub fn diagnosed(model: &Model, campaign: &Campaign) -> Result<Diagnosis, Failure> {
    let spinner = spinner("diagnosing");
    let diagnosis = diagnose(model, campaign, &Quiet);
    spinner.finish_and_clear();
    Ok(diagnosis?)
}

/// What a person types next.
fn next(diagnosis: &Diagnosis, model: &Path, data: &str) -> String {
    let model = shell::path(model);
    if let Some(effect) = diagnosis::first_to_add(diagnosis) {
        return format!("tempco add {model} {effect} {data} -o better.toml");
    }
    if let Some(formula) = diagnosis.unexplained.as_ref().and_then(|unexplained| unexplained.formula.as_ref()) {
        return format!("tempco add {model} {} {data} -o better.toml", shell::option("--expression", formula));
    }
    match diagnosis.verdict {
        Verdict::NothingMissing => format!("tempco export {model} -o calibration.hex"),
        _ => format!("tempco compare {model} {data}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::example::{diagnosis, unexplained};

    #[test]
    fn what_to_type_next_follows_from_what_was_found() {
        let next = |diagnosis: &Diagnosis| next(diagnosis, Path::new("my model.toml"), "a.csv");
        for (diagnosis, line) in [
            (diagnosis(&[("warm-up", &[])]), "tempco add 'my model.toml' warm-up a.csv -o better.toml"),
            (
                unexplained(Some("-supply_v * level_g")),
                "tempco add 'my model.toml' --expression='-supply_v * level_g' a.csv -o better.toml",
            ),
            (unexplained(None), "tempco compare 'my model.toml' a.csv"),
            (diagnosis(&[]), "tempco export 'my model.toml' -o calibration.hex"),
        ] {
            assert_eq!(next(&diagnosis), line);
        }
    }
}
