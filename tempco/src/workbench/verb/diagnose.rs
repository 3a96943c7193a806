//! `tempco diagnose MODEL DATA`

use super::{OfModel, entry, measured};
use crate::workbench::commands;
use crate::workbench::job::{Job, Step};
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::{Finish, Shared, Task};
use std::sync::Arc;
use trainer::diagnose::diagnose;

pub fn run(shared: &Arc<Shared>, OfModel { model: number }: OfModel) -> Result<(), Refusal> {
    let (command, model, campaign) = {
        let session = shared.session();
        let (measured, entry) = (measured(&session)?, entry(&session, number)?);
        let command = commands::diagnose(&entry.file, &measured.data.command_line());
        (command, Arc::clone(&entry.model), Arc::clone(&measured.campaign))
    };
    let work = Box::new(move |job: &Job| {
        let diagnosis = Arc::new(diagnose(&model, &campaign, job)?);
        let finish: Finish = Box::new(move |session| {
            if let Some(entry) = session.entry(number) {
                entry.diagnosis = Some(diagnosis);
            }
            Ok(())
        });
        Ok(finish)
    });
    shared.start(Task { step: Step::Diagnose, what: "Diagnosing".to_owned(), command, work })
}
