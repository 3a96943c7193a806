//! The session as a page receives it.

use super::commands;
use super::session::{Entry, Measured, Session};
use crate::command::inspect::RunSummary;
use crate::render::diagnosis::{first_to_add, verdict};
use serde_json::{Value, json};
use trainer::train::EffectChoice;

/// All of it but the samples.
pub fn state(session: &Session) -> Value {
    json!({
        "version": session.version,
        "folder": session.folder,
        "job": session.running().map(|job| json!({
            "number": job.number, "step": job.step, "what": job.what, "command": job.command, "stopping": job.is_stopped(),
        })),
        "refused": session.refused,
        "stopped": session.stopped,
        "campaign": session.measured.as_ref().map(campaign),
        "models": session.models.iter().map(|entry| model(session, entry)).collect::<Vec<_>>(),
        "current": session.current,
    })
}

fn campaign(measured: &Measured) -> Value {
    let Measured { data, campaign, runs, held_out, split, blind } = measured;
    let is_held_out = |index: usize| split.as_ref().is_ok_and(|split| split.held_out.contains(&index));
    let run = |(index, run): (usize, &RunSummary)| {
        let mut value = json!(run);
        value["held_out"] = is_held_out(index).into();
        value
    };
    json!({
        "command": commands::inspect(&data.command_line()),
        "made_by": blind.as_ref().map(|blind| &blind.command),
        "files": data.files,
        "rows": campaign.row_count(),
        "channels": campaign.channels,
        "ignored_columns": campaign.ignored_columns,
        "signal_unit": campaign.quantity.signal_unit,
        "reference_unit": campaign.quantity.reference_unit,
        "runs": runs.iter().enumerate().map(run).collect::<Vec<_>>(),
        "hold_out": held_out.hold_out,
        "basis": split.as_ref().ok().map(|split| split.basis.to_string()),
        "split_refused": split.as_ref().err(),
        "blind": blind.as_ref().map(|blind| json!({
            "envelope": blind.envelope,
            "noise_ug": blind.noise_ug,
            "command": data.files.first().map(|file| commands::reveal(&blind.envelope, file)),
            "revealed": blind.revealed,
        })),
    })
}

fn model(session: &Session, entry: &Entry) -> Value {
    let data = session.measured.as_ref().map(|measured| measured.data.command_line()).unwrap_or_default();
    let titles: Vec<String> = EffectChoice::of(&entry.model).iter().map(|choice| choice.title().to_owned()).collect();
    json!({
        "number": entry.number,
        "file": entry.file,
        "parent": entry.parent,
        "title": entry.title,
        "effects": entry.model.effects,
        "effect_titles": titles,
        "seed": entry.model.provenance.seed,
        "restarts": entry.model.provenance.restarts,
        "comparison": entry.comparison,
        "simpler": entry.simpler,
        "ladder": entry.ladder,
        "diagnosis": entry.diagnosis.as_deref(),
        "verdict": entry.diagnosis.as_deref().map(verdict),
        "to_add": entry.diagnosis.as_deref().and_then(first_to_add),
        "parity": entry.parity,
        "exported": entry.exported,
        "plan": entry.planned,
        "commands": {
            "made_by": entry.command,
            "compare": commands::compare(&entry.file, &data),
            "diagnose": commands::diagnose(&entry.file, &data),
            "export": commands::export(&entry.file, &session.calibration(entry.number, "hex")),
            "verify": commands::verify(&entry.file, &data),
            "plan": commands::plan(&entry.file, &data, &session.folder.join("next")),
        },
    })
}
