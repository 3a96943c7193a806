//! Looks at another campaign again, with the models that were made of it.

use super::missing;
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::Shared;
use serde::Deserialize;
use std::sync::Arc;

/// The number that the state names.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    campaign: usize,
}

pub fn run(shared: &Arc<Shared>, Request { campaign }: Request) -> Result<(), Refusal> {
    shared.session().idle()?;
    if shared.change(|session| session.bring_back(campaign)) {
        Ok(())
    } else {
        Err(missing("there is no such campaign", "choose one of the list"))
    }
}
