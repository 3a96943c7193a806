//! `tempco plan MODEL DATA`

use super::diagnose::diagnosed;
use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output, make_folder, with_mark};
use crate::progress::spinner;
use crate::recordings::{self, Proposed};
use crate::render;
use crate::shell::{self, option};
use crate::terminal::say;
use clap::Args;
use firmware_core::effect::about;
use std::path::{Path, PathBuf};
use trainer::campaign::Campaign;
use trainer::diagnose::Diagnosis;
use trainer::diagnose::plan::{Plan as Planned, PlanError, Recording, plan};
use trainer::model::Model;
use trainer::progress::{Progress, Quiet};

/// Proposes the next recording: the one that tells best apart what the diagnosis leaves open.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco plan model.toml campaign.csv -o next\n          tempco plan model.toml campaign.csv --effects thermal-lag,thermal-gradient --hours 24"
)]
pub struct Plan {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    data: Data,

    /// Effects to tell apart, instead of those that the diagnosis leaves open; a single one is told from none
    #[arg(long, value_name = "EFFECT,…", value_delimiter = ',')]
    effects: Vec<String>,

    /// Only recordings that keep chamber and turntable busy for at most so long
    #[arg(long, value_name = "H")]
    hours: Option<f64>,

    /// Folder for the best recording's scenario file
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Plan {
    pub fn run(&self) -> Result<Answer, Failure> {
        let model = Model::read(&self.model)?;
        let campaign = self.data.read_for(&model)?;
        let diagnosis = diagnosed(&model, &campaign)?;
        let wish = Wish { effects: self.effects.clone(), hours: self.hours };
        let spinner = spinner("planning");
        let planned = planned(&model, &campaign, &diagnosis, &wish, &Quiet);
        spinner.finish_and_clear();
        let (planned, best) = planned?;
        let best = best.as_ref();
        let written = best.zip(self.output.as_ref()).map(|(best, folder)| written(best, folder, self.force));
        // Which file it is shows only now: where it can't be written, the plan is told all the same.
        let (file, failure) = match written {
            Some(Ok(file)) => (Some(file), None),
            Some(Err(failure)) => (None, Some(failure)),
            None => (None, None),
        };
        if self.json {
            say!("{:#}", json(&planned, file.as_deref()))?;
        } else {
            say!("{}", render::plan::text(&planned))?;
            say!(
                "{}{}",
                self.next(best, file.as_deref()),
                best.map_or_else(String::new, |best| lacking(best, &campaign))
            )?;
        }
        if let Some(failure) = failure {
            return Err(failure);
        }
        Ok(if best.is_some() { Answer::Yes } else { Answer::No })
    }

    /// What a person does next.
    fn next(&self, best: Option<&Proposed>, file: Option<&Path>) -> String {
        let (model, data) = (shell::path(&self.model), self.data.command_line());
        let Some(best) = best else {
            return "No recording here tells them apart any better. Record another quantity: f1 and f2 beside their \
                    difference, or the channel that the effect follows (`tempco effects NAME` says what it needs)."
                .to_owned();
        };
        let Some(file) = file else {
            return format!(
                "Next:  tempco plan {model} {data} -o next      # writes {} as a scenario",
                best.scenario.name
            );
        };
        format!(
            "{} is written to {}.\nRehearse it:  tempco simulate {} -o new.csv\nOnce it is recorded:  tempco train {data} \
             new.csv -o model2.toml && tempco diagnose model2.toml {data} new.csv",
            best.scenario.name,
            file.display(),
            shell::path(file)
        )
    }
}

/// What is asked of a plan.
#[derive(Clone, Debug, Default)]
pub struct Wish {
    /// Effects to tell apart, instead of those that the diagnosis leaves open.
    pub effects: Vec<String>,
    /// Only recordings that take at most so long, hours.
    pub hours: Option<f64>,
}

impl Wish {
    /// The options that it is on a command line.
    pub fn words(&self) -> String {
        let effects = (!self.effects.is_empty()).then(|| format!(" {}", option("--effects", &self.effects.join(","))));
        let hours = self.hours.map(|hours| format!(" --hours {hours}"));
        effects.into_iter().chain(hours).collect()
    }
}

/// The plan, and the best recording if it is any good.
pub fn planned(
    model: &Model,
    campaign: &Campaign,
    diagnosis: &Diagnosis,
    wish: &Wish,
    progress: &dyn Progress,
) -> Result<(Planned, Option<Proposed>), Failure> {
    let proposed = recordings(wish, campaign, diagnosis)?;
    let recordings: Vec<Recording> = proposed.iter().map(|one| one.recording.clone()).collect();
    let planned = plan(model, campaign, diagnosis, &wish.effects, &recordings, progress).map_err(explained)?;
    let best = planned.proposals.first().filter(|best| best.is_useful());
    let best = best.and_then(|best| proposed.into_iter().find(|one| one.recording.name == best.recording));
    Ok((planned, best))
}

/// The recordings that there is time for.
fn recordings(wish: &Wish, campaign: &Campaign, diagnosis: &Diagnosis) -> Result<Vec<Proposed>, Failure> {
    let unseen = diagnosis.unobservable.iter().map(|one| &one.effect);
    let columns: Vec<&str> = wish.effects.iter().chain(unseen).filter_map(|name| column(name)).collect();
    let mut all = recordings::all(campaign, &columns)?;
    let shortest_h = all.iter().map(|one| one.recording.hours).fold(f64::INFINITY, f64::min);
    all.retain(|one| wish.hours.is_none_or(|hours| one.recording.hours <= hours));
    if all.is_empty() {
        return Err(Failure::new("no recording is as short as that")
            .help(format_args!("the shortest takes {shortest_h:.1} hours: --hours {:.0}", shortest_h.ceil())));
    }
    Ok(all)
}

/// Columns that the recording has and the campaign hasn't: both can be read together only when both have them.
fn lacking(best: &Proposed, campaign: &Campaign) -> String {
    let planned = &best.recording.campaign.channels;
    let names: Vec<&str> =
        planned.iter().filter(|name| !campaign.channels.contains(name)).map(String::as_str).collect();
    if names.is_empty() {
        return String::new();
    }
    format!(
        "\nWrite {} into the old files too, as it was then: files with different channels can't be read together.",
        names.join(", ")
    )
}

/// The column that an effect follows besides time and temperature.
fn column(effect: &str) -> Option<&'static str> {
    let about = about(effect)?;
    about.channel.or_else(|| about.needs.contains("age_days").then_some("age_days"))
}

/// Writes the recording as a scenario file into a folder.
pub fn write(best: &Proposed, folder: &Path) -> Result<PathBuf, Failure> {
    written(best, folder, Force::default())
}

fn written(best: &Proposed, folder: &Path, force: Force) -> Result<PathBuf, Failure> {
    let file = folder.join(format!("{}.toml", best.scenario.name));
    make_folder(folder)?;
    let text = format!(
        "# {:.1} hours of chamber and turntable. No sensor is described here: a rehearsal with `tempco simulate` takes a\n# nominal one, with the [device], [noise] and [effects] that you add.\n\n{}",
        best.recording.hours,
        recordings::text(&best.scenario)
    );
    Output::in_folder(&file, Kind::Scenario, "-o", force).write(&with_mark(Kind::Scenario, text.as_bytes()))?;
    Ok(file)
}

fn json(plan: &Planned, file: Option<&Path>) -> serde_json::Value {
    let mut object = serde_json::json!(plan);
    object["file"] = serde_json::json!(file);
    object
}

fn explained(error: PlanError) -> Failure {
    let help = match &error {
        PlanError::NothingOpen => Some("--effects a,b names two effects to tell apart all the same"),
        PlanError::UnknownEffect(_) => Some("write names as in --effects thermal-lag,thermal-gradient"),
        PlanError::NoAccelerometer(_) | PlanError::Diagnose(_) => None,
    };
    let failure = Failure::new(error);
    match help {
        Some(help) => failure.help(help),
        None => failure,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wish_is_typed_again_as_the_options_that_it_is() {
        assert_eq!(Wish::default().words(), "");
        let wish = Wish { effects: vec!["thermal-lag".to_owned(), "warm-up".to_owned()], hours: Some(2.5) };
        assert_eq!(wish.words(), " --effects thermal-lag,warm-up --hours 2.5");
        assert_eq!(Wish { hours: None, ..wish }.words(), " --effects thermal-lag,warm-up");
    }

    #[test]
    fn an_effect_follows_the_column_of_its_channel_or_the_age() {
        assert_eq!(column("supply-voltage"), Some("supply_v"));
        assert_eq!(column("aging"), Some("age_days"));
        assert_eq!((column("thermal-lag"), column("nothing")), (None, None));
    }
}
