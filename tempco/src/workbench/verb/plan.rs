//! `tempco plan MODEL DATA`

use super::{entry, measured};
use crate::command::plan::{Wish, planned, write};
use crate::render::plan::text;
use crate::workbench::entry::Planned;
use crate::workbench::job::{Job, Step};
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::{Finish, Shared, Task};
use crate::workbench::{commands, places};
use serde::Deserialize;
use std::sync::Arc;
use trainer::diagnose::diagnose;

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

pub fn run(shared: &Arc<Shared>, Request { model: number, effects, hours }: Request) -> Result<(), Refusal> {
    let (command, model, known, campaign) = {
        let session = shared.session();
        let (measured, entry) = (measured(&session)?, entry(&session, number)?);
        let command = commands::plan(&entry.file, &measured.data.command_line());
        (command, Arc::clone(&entry.model), entry.diagnosis.clone(), Arc::clone(&measured.campaign))
    };
    let wish = Wish { effects, hours };
    let planned_by = format!("{command}{}", wish.words());
    let command = commands::into(&planned_by, &places::plan(&shared.session().folder, number));
    let work = Box::new(move |job: &Job| {
        let diagnosis = known.map_or_else(|| diagnose(&model, &campaign, job).map(Arc::new), Ok)?;
        let (plan, best) = planned(&model, &campaign, &diagnosis, &wish, job)?;
        let finish: Finish = Box::new(move |session| {
            let folder = places::plan(&session.folder, number);
            let file = best.as_ref().map(|best| write(best, &folder)).transpose()?;
            let command = commands::into(&planned_by, &folder);
            if let Some(entry) = session.entry(number) {
                let plan = Planned { text: text(&plan), plan, command, file };
                (entry.diagnosis, entry.planned) = (Some(diagnosis), Some(plan));
            }
            Ok(())
        });
        Ok(finish)
    });
    shared.start(Task { step: Step::Plan, what: "Planning the next recording".to_owned(), command, work })
}
