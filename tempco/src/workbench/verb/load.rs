//! `tempco inspect DATA`: reads a campaign.

use crate::command::inspect::RunSummary;
use crate::data::{Data, HeldOut, Reading};
use crate::failure::Failure;
use crate::workbench::bench::{Bench, Finish, Refusal, Task};
use crate::workbench::job::Step;
use crate::workbench::session::{Blind, Measured};
use crate::workbench::{commands, uploads};
use serde::Deserialize;
use std::sync::Arc;
use trainer::campaign::Campaign;

/// Files that were uploaded, and how to read them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    files: Vec<String>,
    /// As `--map` takes them.
    #[serde(default)]
    map: Vec<String>,
}

pub fn run(bench: &Arc<Bench>, Request { files, map }: Request) -> Result<(), Refusal> {
    let folder = bench.session().folder.clone();
    // A campaign.toml beside the tables says how to read them; it is found there, not named.
    let tables = files.iter().filter(|name| !name.ends_with(".toml"));
    let files = tables.map(|name| uploads::path(&folder, name)).collect::<Result<Vec<_>, _>>()?;
    start(bench, Data { files, reading: Reading { map, ..Reading::default() } })
}

/// Begins to read.
pub fn start(bench: &Arc<Bench>, data: Data) -> Result<(), Refusal> {
    let command = commands::inspect(&data.command_line());
    let work = Box::new(move |_: &_| {
        let campaign = data.read()?;
        Ok(take(measured(data, campaign, None)))
    });
    bench.start(Task { step: Step::Load, what: "Reading the campaign".to_owned(), command, work })
}

/// A campaign divided as usual.
pub fn measured(data: Data, campaign: Campaign, blind: Option<Blind>) -> Measured {
    let runs = campaign.runs.iter().map(|run| RunSummary::of(&campaign, run)).collect();
    let held_out = HeldOut::default();
    let split = campaign.split(&held_out.choice()).map_err(Failure::from);
    Measured { data, campaign: Arc::new(campaign), runs: Arc::new(runs), held_out, split, blind }
}

/// Puts it on the bench.
pub fn take(measured: Measured) -> Finish {
    Box::new(move |session| session.take(measured))
}
