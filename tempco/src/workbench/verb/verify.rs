//! `tempco verify MODEL DATA`

use super::{OfModel, entry, measured};
use crate::command::verify::{Parity, verified};
use crate::failure::Failure;
use crate::workbench::commands;
use crate::workbench::job::{Job, Step};
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::{Finish, Shared, Task};
use std::ops::ControlFlow;
use std::sync::Arc;
use trainer::campaign::Campaign;
use trainer::model::Model;
use trainer::residuals::arranged;

pub fn run(shared: &Arc<Shared>, OfModel { model: number }: OfModel) -> Result<(), Refusal> {
    let (command, model, campaign) = {
        let session = shared.session();
        let (measured, entry) = (measured(&session)?, entry(&session, number)?);
        let command = commands::verify(&entry.file, &measured.data.command_line());
        (command, Arc::clone(&entry.model), Arc::clone(&measured.campaign))
    };
    let work = Box::new(move |job: &Job| {
        let parity = replayed(job, &model, &campaign)?;
        let finish: Finish = Box::new(move |session| {
            if let Some(entry) = session.entry(number) {
                entry.parity = Some(parity);
            }
            Ok(())
        });
        Ok(finish)
    });
    shared.start(Task { step: Step::Verify, what: "Replaying on the virtual instrument".to_owned(), command, work })
}

fn replayed(job: &Job, model: &Model, campaign: &Campaign) -> Result<Parity, Failure> {
    let (blob, campaign) = (model.to_blob()?, arranged(model, campaign)?);
    let rows = campaign.row_count().max(1) as f64;
    verified(&blob, &campaign, |samples| {
        job.done(samples as f64 / rows);
        if job.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}
