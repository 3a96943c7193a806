//! Looks at another model: back to the one before, or to any.

use super::{OfModel, entry};
use crate::workbench::bench::{Bench, Refusal};
use std::sync::Arc;

pub fn run(bench: &Arc<Bench>, OfModel { model }: OfModel) -> Result<(), Refusal> {
    entry(&bench.session(), model)?;
    bench.change(|session| session.current = Some(model));
    Ok(())
}
