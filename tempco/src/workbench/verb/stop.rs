//! Stops what goes on.

use crate::workbench::bench::{Bench, Refusal};
use serde::Deserialize;
use std::sync::Arc;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {}

pub fn run(bench: &Arc<Bench>, _: Request) -> Result<(), Refusal> {
    bench.change(|session| {
        if let Some(job) = session.running() {
            job.stop();
        }
    });
    Ok(())
}
