//! `tempco add` and `tempco remove`

use super::{entry, measured};
use crate::command::change::{Change, Ladder};
use crate::failure::Failure;
use crate::workbench::commands;
use crate::workbench::entry::{Entry, Origin};
use crate::workbench::job::{Job, Step};
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::{Finish, Shared, Task};
use crate::workbench::verb::train::keep;
use serde::Deserialize;
use std::sync::Arc;
use trainer::campaign::{Campaign, Split};
use trainer::model::Model;
use trainer::train::{EffectChoice, TrainSettings, train};

/// An effect of the catalogue, or one's own.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    model: usize,
    #[serde(default)]
    effect: Option<String>,
    #[serde(default)]
    expression: Option<String>,
}

impl Request {
    /// The model's number and the effect.
    fn subject(self) -> Result<(usize, EffectChoice), Failure> {
        match (self.expression, self.effect) {
            (Some(text), _) => Ok((self.model, EffectChoice::expression(&text))),
            (None, Some(name)) => Ok((self.model, EffectChoice::named(&name))),
            (None, None) => Err(Failure::new("no effect is named").help("choose one, or write an expression")),
        }
    }
}

pub fn add(shared: &Arc<Shared>, request: Request) -> Result<(), Refusal> {
    change(shared, request, "add", &|change, effect| change.with(effect.clone()))
}

pub fn remove(shared: &Arc<Shared>, request: Request) -> Result<(), Refusal> {
    change(shared, request, "remove", &|change, effect| change.without(effect))
}

type Effects<'a> = &'a dyn Fn(&Change, &EffectChoice) -> Result<Vec<EffectChoice>, Failure>;

fn change(shared: &Arc<Shared>, request: Request, verb: &str, effects: Effects) -> Result<(), Refusal> {
    let (number, effect) = request.subject()?;
    let (model, campaign, origin, command) = {
        let session = shared.session();
        let (measured, entry) = (measured(&session)?, entry(&session, number)?);
        let command = commands::change(verb, entry, &effect, &measured.data.command_line());
        let foretold = session.foretold(&command);
        let sign = if verb == "add" { "+" } else { "−" };
        let title = format!("{sign} {}", effect.title());
        let origin = Origin { parent: Some(entry.number), title, command };
        (Arc::clone(&entry.model), Arc::clone(&measured.campaign), origin, foretold)
    };
    let effects = effects(&Change::of(&model, &campaign)?, &effect)?;
    let what = format!("Training {}", if verb == "add" { "with it" } else { "without it" });
    let work = Box::new(move |job: &Job| climbed(job, &model, &campaign, &effects, origin));
    shared.start(Task { step: Step::Add, what, command, work })
}

fn climbed(
    job: &Job,
    model: &Model,
    campaign: &Campaign,
    effects: &[EffectChoice],
    origin: Origin,
) -> Result<Finish, Failure> {
    let train =
        |split: &Split, settings: &TrainSettings, _: &str| train(campaign, split, settings, job).map_err(Failure::from);
    let ladder = Change::of(model, campaign)?.climb(effects, train, |rung| job.rung(rung))?;
    let Ladder { rungs, model, comparison, doubts } = ladder;
    let entry = Entry::compared(origin, model, comparison, campaign)?;
    Ok(keep(Entry { ladder: rungs, doubts, ..entry }))
}
