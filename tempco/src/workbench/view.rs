//! The session as a page receives it.

use super::commands;
use super::entry::{Entry, Exported, Planned};
use super::measured::Measured;
use super::places;
use super::session::Session;
use crate::command::inspect::RunSummary;
use crate::render::diagnosis::{first_to_add, verdict};
use serde_json::{Value, json};
use std::path::Path;
use trainer::train::EffectChoice;

/// All of it but the samples.
pub fn state(session: &Session) -> Value {
    json!({
        "version": session.version,
        "folder": shown(&session.folder),
        "job": session.running().map(|job| json!({
            "number": job.number, "step": job.step, "what": job.what, "command": job.command, "stopping": job.is_stopped(),
        })),
        "refused": session.refused,
        "stopped": session.stopped,
        "campaign": session.measured.as_ref().map(campaign),
        "campaigns": campaigns(session),
        "models": session.models.iter().map(|entry| model(session, entry)).collect::<Vec<_>>(),
        "current": session.current,
    })
}

/// All of them in the order in which they came, with the numbers of their models.
fn campaigns(session: &Session) -> Value {
    let summary = |number: usize, measured: &Measured, models: &[Entry]| {
        json!({
            "number": number,
            "files": files(measured),
            "rows": measured.campaign.row_count(),
            "models": models.iter().map(|entry| entry.number).collect::<Vec<_>>(),
            "current": number == session.campaign,
        })
    };
    let now = session.measured.iter().map(|measured| summary(session.campaign, measured, &session.models));
    let shelved = session.shelf.iter().map(|one| summary(one.number, &one.measured, &one.models));
    let mut all: Vec<Value> = shelved.chain(now).collect();
    all.sort_by_key(|one| one["number"].as_u64());
    all.into()
}

fn files(measured: &Measured) -> Vec<String> {
    measured.data.files.iter().map(|file| shown(file)).collect()
}

/// A path for people: not every name is Unicode.
fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn campaign(measured: &Measured) -> Value {
    let Measured { data, mappings, campaign, runs, held_out, split, blind } = measured;
    let is_held_out = |index: usize| split.as_ref().is_ok_and(|split| split.held_out.contains(&index));
    let run = |(index, run): (usize, &RunSummary)| {
        let mut value = json!(run);
        value["held_out"] = is_held_out(index).into();
        value
    };
    json!({
        "command": commands::inspect(&data.command_line()),
        "made_by": blind.as_ref().map(|blind| &blind.command),
        "files": files(measured),
        "mappings": mappings.iter().map(|file| shown(file)).collect::<Vec<_>>(),
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
            "envelope": shown(&blind.envelope),
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
        "file": shown(&entry.file),
        "parent": entry.parent,
        "title": entry.title,
        "effects": entry.model.effects,
        "effect_titles": titles,
        "seed": entry.model.provenance.seed,
        "restarts": entry.model.provenance.restarts,
        "comparison": entry.comparison,
        "simpler": entry.simpler,
        "ladder": entry.ladder,
        "doubts": entry.doubts,
        "diagnosis": entry.diagnosis.as_deref(),
        "verdict": entry.diagnosis.as_deref().map(verdict),
        "to_add": entry.diagnosis.as_deref().and_then(first_to_add),
        "parity": entry.parity,
        "exported": entry.exported.as_ref().map(exported),
        "plan": entry.planned.as_ref().map(planned),
        "commands": {
            "made_by": entry.command,
            "compare": commands::compare(&entry.file, &data),
            "diagnose": commands::diagnose(&entry.file, &data),
            "export": export(session, entry),
            "verify": commands::verify(&entry.file, &data),
            "plan": plan(session, entry, &data),
        },
    })
}

fn exported(Exported { files: [(hex, _), (bin, bytes)], address }: &Exported) -> Value {
    json!({ "hex": shown(hex), "bin": shown(bin), "bytes": bytes.len(), "address": address })
}

fn planned(planned: &Planned) -> Value {
    let mut value = json!(planned);
    value["file"] = planned.file.as_deref().map(shown).into();
    value["rehearse"] = planned.file.as_deref().map(commands::rehearse).into();
    value
}

fn export(session: &Session, entry: &Entry) -> String {
    let [hex, bin] = ["hex", "bin"].map(|ending| places::calibration(&session.folder, entry.number, ending));
    commands::export(&entry.file, &hex, &bin)
}

/// The one that made the plan, or that would.
fn plan(session: &Session, entry: &Entry, data: &str) -> String {
    let would = || commands::into(&commands::plan(&entry.file, data), &places::plan(&session.folder, entry.number));
    entry.planned.as_ref().map_or_else(would, |planned| planned.command.clone())
}
