//! `--hold-out`: which runs judge.

use super::measured;
use crate::data::HeldOut;
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::Shared;
use serde::Deserialize;
use std::sync::Arc;

/// Names of runs, nothing for the usual choice, an empty list for none.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    hold_out: Option<Vec<String>>,
}

pub fn run(shared: &Arc<Shared>, Request { hold_out }: Request) -> Result<(), Refusal> {
    let none = hold_out.as_ref().is_some_and(Vec::is_empty);
    let held_out = HeldOut { hold_out: if none { Some(vec!["none".to_owned()]) } else { hold_out } };
    let campaign = Arc::clone(&measured(&shared.session())?.campaign);
    let split = campaign.split(&held_out.choice(&campaign)).map_err(crate::failure::Failure::from)?;
    shared.change(|session| {
        if let Some(measured) = &mut session.measured {
            (measured.held_out, measured.split) = (held_out, Ok(split));
        }
    });
    Ok(())
}
