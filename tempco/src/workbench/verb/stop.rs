//! Stops what goes on.

use crate::workbench::refusal::Refusal;
use crate::workbench::shared::Shared;
use serde::Deserialize;
use std::sync::Arc;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {}

pub fn run(shared: &Arc<Shared>, _: Request) -> Result<(), Refusal> {
    shared.change(|session| {
        if let Some(job) = session.running() {
            job.stop();
        }
    });
    Ok(())
}
