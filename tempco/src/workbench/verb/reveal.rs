//! `tempco reveal campaign.sealed`

use super::{measured, missing};
use crate::command::demo::judged;
use crate::command::reveal::{json, opened};
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::Shared;
use serde::Deserialize;
use std::sync::Arc;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {}

pub fn run(shared: &Arc<Shared>, _: Request) -> Result<(), Refusal> {
    let (envelope, data, diagnosis) = {
        let session = shared.session();
        let measured = measured(&session)?;
        let nothing = || missing("this campaign hides nothing", "`tempco workbench --demo` makes one that does");
        let (blind, data) = measured.blind.as_ref().zip(measured.data.files.first()).ok_or_else(nothing)?;
        // The first answer counts: later ones are of models that were told already.
        let diagnosis = session.models.iter().find_map(|entry| entry.diagnosis.clone());
        (blind.envelope.clone(), data.clone(), diagnosis)
    };
    let truth = opened(&envelope, &data)?;
    let mut revealed = json(&truth);
    revealed["judgement"] = diagnosis.map(|diagnosis| judged(&truth, &diagnosis)).into();
    shared.change(|session| {
        if let Some(blind) = session.measured.as_mut().and_then(|measured| measured.blind.as_mut()) {
            blind.revealed = Some(revealed);
        }
    });
    Ok(())
}
