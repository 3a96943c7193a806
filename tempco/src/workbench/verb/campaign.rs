//! Looks at another campaign again, with the models that were made of it.

use super::missing;
use crate::workbench::bench::{Bench, Refusal};
use serde::Deserialize;
use std::sync::Arc;

/// The number that the state names.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    campaign: usize,
}

pub fn run(bench: &Arc<Bench>, Request { campaign }: Request) -> Result<(), Refusal> {
    bench.session().idle()?;
    if bench.change(|session| session.bring_back(campaign)) {
        Ok(())
    } else {
        Err(missing("there is no such campaign", "choose one of the list"))
    }
}
