//! `tempco train DATA`

use super::measured;
use crate::command::train::{Simpler, Training, split};
use crate::failure::Failure;
use crate::workbench::commands;
use crate::workbench::entry::{Entry, Origin};
use crate::workbench::job::{Job, Step};
use crate::workbench::measured::Measured;
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::{Finish, Shared, Task};
use std::sync::Arc;
use trainer::train::{TrainSettings, train};

pub fn run(shared: &Arc<Shared>, training: Training) -> Result<(), Refusal> {
    let (measured, origin, command) = {
        let session = shared.session();
        let measured = measured(&session)?.clone();
        let command = commands::train(&measured, &training);
        let foretold = session.foretold(&command);
        (measured, Origin { parent: None, title: training.title(), command }, foretold)
    };
    let work = Box::new(move |job: &Job| trained(job, &measured, &training.settings(), origin));
    shared.start(Task { step: Step::Train, what: "Training".to_owned(), command, work })
}

fn trained(job: &Job, measured: &Measured, settings: &TrainSettings, origin: Origin) -> Result<Finish, Failure> {
    let Measured { campaign, held_out, .. } = measured;
    let split = split(campaign, &held_out.choice(campaign), settings)?;
    let trained = train(campaign, &split, settings, job)?;
    let entry = Entry::new(origin, trained.model.clone(), campaign)?;
    Ok(keep(Entry { simpler: Simpler::all(&trained, campaign, &split), ..entry }))
}

/// Writes the model and shows it, unless it was trained in vain.
pub fn keep(entry: Entry) -> Finish {
    Box::new(move |session| session.add(entry))
}
