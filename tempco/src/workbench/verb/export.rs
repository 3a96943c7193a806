//! `tempco export MODEL`

use super::{OfModel, entry};
use crate::command::export::write;
use crate::failure::Failure;
use crate::workbench::entry::Exported;
use crate::workbench::places;
use crate::workbench::refusal::Refusal;
use crate::workbench::shared::Shared;
use axum::extract::{Query, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Writes the calibration in both formats.
pub fn run(shared: &Arc<Shared>, OfModel { model: number }: OfModel) -> Result<(), Refusal> {
    let (model, known, paths) = {
        let session = shared.session();
        let entry = entry(&session, number)?;
        let paths = ["hex", "bin"].map(|ending| places::calibration(&session.folder, number, ending));
        (Arc::clone(&entry.model), entry.exported.clone(), paths)
    };
    for path in &paths {
        check(path, known.as_ref())?;
    }
    let bytes = model.to_bytes().map_err(Failure::from)?;
    let address = write(&paths[0], &bytes)?.trim_start_matches(", ").to_owned();
    write(&paths[1], &bytes)?;
    let [hex, bin] = paths.map(written);
    let exported = Exported { files: [hex?, bin?], address };
    shared.change(|session| {
        if let Some(entry) = session.entry(number) {
            entry.exported = Some(exported);
        }
    });
    Ok(())
}

fn written(path: PathBuf) -> Result<(PathBuf, Vec<u8>), Failure> {
    places::plain_file(&path)?;
    let bytes = std::fs::read(&path).map_err(|error| Failure::io(&path, &error))?;
    Ok((path, bytes))
}

/// Refuses to write over anything but what was exported before.
fn check(path: &Path, known: Option<&Exported>) -> Result<(), Failure> {
    let is_own = |path: &Path| {
        let before = known.and_then(|known| known.files.iter().find(|(file, _)| file == path));
        before.is_some() && written(path.to_owned()).is_ok_and(|now| Some(&now) == before)
    };
    if !places::is_taken(path) || is_own(path) {
        return Ok(());
    }
    Err(Failure::new(format_args!("{}: this is another file, and would be lost", path.display()))
        .help("move it elsewhere, and export again"))
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
pub async fn download(State(shared): State<Arc<Shared>>, Query(wanted): Query<Wanted>) -> Response {
    match file(&shared, &wanted) {
        Ok((name, bytes)) => {
            let disposition = format!("attachment; filename=\"{name}\"");
            let kind = (header::CONTENT_TYPE, "application/octet-stream".to_owned());
            ([kind, (header::CONTENT_DISPOSITION, disposition)], bytes).into_response()
        }
        Err(refusal) => refusal.into_response(),
    }
}

fn file(shared: &Shared, Wanted { model, format }: &Wanted) -> Result<(String, Vec<u8>), Refusal> {
    let session = shared.session();
    let entry = entry(&session, *model)?;
    let nothing = || super::missing("nothing is exported", "export it first");
    let exported = |which: usize| entry.exported.as_ref().map(|one| one.files[which].clone()).ok_or_else(nothing);
    // What was written, not what may lie there now.
    let (path, bytes) = match format {
        Format::Toml => (entry.file.clone(), entry.model.to_text().into_bytes()),
        Format::Hex => exported(0)?,
        Format::Bin => exported(1)?,
    };
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok((name, bytes))
}
