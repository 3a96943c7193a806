//! `tempco plan MODEL DATA`

use super::{entry, measured};
use crate::command::plan::{Wish, planned, write};
use crate::failure::Failure;
use crate::render::plan::text;
use crate::workbench::bench::{Bench, Finish, Refusal, Task};
use crate::workbench::commands;
use crate::workbench::job::{Job, Step};
use crate::workbench::session::Planned;
use serde::Deserialize;
use std::path::Path;
use std::sync::Arc;
use trainer::campaign::Campaign;
use trainer::diagnose::{Diagnosis, diagnose};
use trainer::model::Model;

/// What is to be told apart, and the time there is for it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    model: usize,
    #[serde(default)]
    effects: Vec<String>,
    #[serde(default)]
    hours: Option<f64>,
}

pub fn run(bench: &Arc<Bench>, Request { model: number, effects, hours }: Request) -> Result<(), Refusal> {
    let (command, model, known, campaign, folder) = {
        let session = bench.session();
        let (measured, entry) = (measured(&session)?, entry(&session, number)?);
        let folder = session.folder.join("next");
        let command = commands::plan(&entry.file, &measured.data.command_line(), &folder);
        (command, Arc::clone(&entry.model), entry.diagnosis.clone(), Arc::clone(&measured.campaign), folder)
    };
    let wish = Wish { effects, hours };
    let command = format!("{command}{}", wish.words());
    let work = Box::new(move |job: &Job| {
        let diagnosis = known.map_or_else(|| diagnose(&model, &campaign, job).map(Arc::new), Ok)?;
        let plan = next(job, &model, &campaign, &diagnosis, &wish, &folder)?;
        let finish: Finish = Box::new(move |session| {
            if let Some(entry) = session.entry(number) {
                (entry.diagnosis, entry.planned) = (Some(diagnosis), Some(plan));
            }
        });
        Ok(finish)
    });
    bench.start(Task { step: Step::Plan, what: "Planning the next recording".to_owned(), command, work })
}

fn next(
    job: &Job,
    model: &Model,
    campaign: &Campaign,
    diagnosis: &Diagnosis,
    wish: &Wish,
    folder: &Path,
) -> Result<Planned, Failure> {
    let (plan, best) = planned(model, campaign, diagnosis, wish, job)?;
    let file = best.as_ref().filter(|_| !job.is_stopped()).map(|best| write(best, folder)).transpose()?;
    Ok(Planned { text: text(&plan), plan, file })
}
