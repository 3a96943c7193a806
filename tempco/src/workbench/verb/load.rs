//! `tempco inspect DATA`: reads a campaign.

use crate::command::inspect::RunSummary;
use crate::data::{Data, HeldOut, Reading};
use crate::failure::Failure;
use crate::workbench::job::Step;
use crate::workbench::measured::{Blind, Measured};
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::{Finish, Shared, Task};
use crate::workbench::{commands, places, uploads};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use trainer::campaign::Campaign;

/// Files of one upload, and how to read them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    upload: u64,
    files: Vec<String>,
    /// As `--map` takes them.
    #[serde(default)]
    map: Vec<String>,
}

pub fn run(shared: &Arc<Shared>, Request { upload, files, map }: Request) -> Result<(), Refusal> {
    let folder = {
        let session = shared.session();
        session.idle()?;
        uploads::opened(&session, upload)?
    };
    let files = tables(&folder, &files)?;
    // What was read stays as it was read.
    shared.session().uploads.retain(|open| *open != folder);
    start(shared, Data { files, reading: Reading { map, ..Reading::default() } })
}

/// The tables of an upload. What says how to read them is found beside them, not named.
fn tables(folder: &Path, names: &[String]) -> Result<Vec<PathBuf>, Failure> {
    let mapping = folder.join(MAPPING);
    if places::is_taken(&mapping) {
        places::plain_file(&mapping)?;
    }
    let mut tables = Vec::new();
    for name in names {
        let file = uploads::path(folder, name)?;
        places::plain_file(&file)?;
        match name.as_str() {
            MAPPING => {}
            other if other.ends_with(".toml") => {
                return Err(Failure::new(format_args!("{other} is no table"))
                    .help("what says how to read tables is named campaign.toml; drop it together with them"));
            }
            _ => tables.push(file),
        }
    }
    if tables.is_empty() {
        return Err(Failure::new("there is no table among these files").help("drop the CSV files together with it"));
    }
    Ok(tables)
}

/// The file beside tables that says how to read them.
const MAPPING: &str = "campaign.toml";

/// Those that the reader follows.
fn mappings(data: &Data) -> Vec<PathBuf> {
    let folder = |file: &PathBuf| if file.is_dir() { Some(file.clone()) } else { file.parent().map(Path::to_owned) };
    let mut found: Vec<PathBuf> = data.files.iter().filter_map(folder).map(|folder| folder.join(MAPPING)).collect();
    found.sort();
    found.dedup();
    found.retain(|file| file.exists());
    found
}

/// Begins to read.
pub fn start(shared: &Arc<Shared>, data: Data) -> Result<(), Refusal> {
    let command = commands::inspect(&data.command_line());
    let work = Box::new(move |_: &_| {
        let campaign = data.read()?;
        Ok(take(measured(data, campaign, None)))
    });
    shared.start(Task { step: Step::Load, what: "Reading the campaign".to_owned(), command, work })
}

/// A campaign divided as usual.
pub fn measured(data: Data, campaign: Campaign, blind: Option<Blind>) -> Measured {
    let runs = campaign.runs.iter().map(|run| RunSummary::of(&campaign, run)).collect();
    let held_out = HeldOut::default();
    let split = campaign.split(&held_out.choice(&campaign)).map_err(Failure::from);
    let mappings = mappings(&data);
    Measured { data, mappings, campaign: Arc::new(campaign), runs: Arc::new(runs), held_out, split, blind }
}

/// From now on it is the one that is looked at.
pub fn take(measured: Measured) -> Finish {
    Box::new(move |session| {
        session.take(measured);
        Ok(())
    })
}
