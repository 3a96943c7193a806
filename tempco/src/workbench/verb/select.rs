//! Looks at another model: back to the one before, or to any.

use super::{OfModel, entry};
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::Shared;
use std::sync::Arc;

pub fn run(shared: &Arc<Shared>, OfModel { model }: OfModel) -> Result<(), Refusal> {
    entry(&shared.session(), model)?;
    shared.change(|session| session.current = Some(model));
    Ok(())
}
