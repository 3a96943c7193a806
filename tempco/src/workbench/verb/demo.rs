//! `tempco simulate rich --blind`: a campaign that hides an effect, as `tempco demo` makes it.

use super::load::{measured, take};
use crate::command::demo::{self, SCENARIO, SEED};
use crate::data::{Data, Reading};
use crate::workbench::job::Step;
use crate::workbench::measured::Blind;
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::{Shared, Task};
use crate::workbench::{commands, places};
use serde::Deserialize;
use std::sync::Arc;

/// Which of them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    #[serde(default)]
    pub seed: Option<u64>,
}

pub fn run(shared: &Arc<Shared>, Request { seed }: Request) -> Result<(), Refusal> {
    let seed = seed.unwrap_or(SEED);
    let folder = {
        let session = shared.session();
        session.idle()?;
        places::new_folder(&session.folder, "demo")?
    };
    let command = commands::simulate(SCENARIO, seed, &folder.join("campaign.csv"));
    let made_by = command.clone();
    let work = Box::new(move |_: &_| {
        let made = demo::measure(&folder, seed)?;
        let data = Data { files: vec![made.data], reading: Reading::default() };
        let blind = Blind { envelope: made.envelope, command: made_by, noise_ug: made.noise_ug, revealed: None };
        Ok(take(measured(data, made.campaign, Some(blind))))
    });
    shared.start(Task {
        step: Step::Load,
        what: "Simulating a campaign that hides an effect".to_owned(),
        command,
        work,
    })
}
