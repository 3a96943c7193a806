//! `tempco export MODEL`

use super::{OfModel, entry};
use crate::command::export::write;
use crate::failure::Failure;
use crate::workbench::bench::{Bench, Refusal};
use crate::workbench::session::Exported;
use axum::extract::{Query, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use std::sync::Arc;

/// Writes the calibration in both formats.
pub fn run(bench: &Arc<Bench>, OfModel { model: number }: OfModel) -> Result<(), Refusal> {
    let (model, hex, bin) = {
        let session = bench.session();
        let model = Arc::clone(&entry(&session, number)?.model);
        (model, session.calibration(number, "hex"), session.calibration(number, "bin"))
    };
    let bytes = model.to_bytes().map_err(Failure::from)?;
    let address = write(&hex, &bytes)?.trim_start_matches(", ").to_owned();
    write(&bin, &bytes)?;
    let exported = Exported { hex, bin, bytes: bytes.len(), address };
    bench.change(|session| {
        if let Some(entry) = session.entry(number) {
            entry.exported = Some(exported);
        }
    });
    Ok(())
}

/// `?model=1&format=hex`
#[derive(Deserialize)]
pub struct Wanted {
    model: usize,
    format: Format,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Format {
    Hex,
    Bin,
    Toml,
}

/// `GET /api/download?model=1&format=hex`: what was exported, or the model file.
pub async fn download(State(bench): State<Arc<Bench>>, Query(wanted): Query<Wanted>) -> Response {
    match file(&bench, &wanted) {
        Ok((name, bytes)) => {
            let disposition = format!("attachment; filename=\"{name}\"");
            let kind = (header::CONTENT_TYPE, "application/octet-stream".to_owned());
            ([kind, (header::CONTENT_DISPOSITION, disposition)], bytes).into_response()
        }
        Err(refusal) => refusal.into_response(),
    }
}

fn file(bench: &Bench, Wanted { model, format }: &Wanted) -> Result<(String, Vec<u8>), Refusal> {
    let path = {
        let session = bench.session();
        let entry = entry(&session, *model)?;
        let exported =
            || entry.exported.as_ref().ok_or_else(|| super::missing("nothing is exported", "export it first"));
        match format {
            Format::Toml => entry.file.clone(),
            Format::Hex => exported()?.hex.clone(),
            Format::Bin => exported()?.bin.clone(),
        }
    };
    let bytes = std::fs::read(&path).map_err(|error| Failure::io(&path, &error))?;
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok((name, bytes))
}
