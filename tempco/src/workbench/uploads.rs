//! Files that are dropped on the page. Those that are dropped together get a new folder of their own, and keep their names
//! in it: errors name them, so does every command line, and what says how to read some says nothing about others.

use super::json::json;
use super::places;
use super::refusal::Refusal;
use super::session::Session;
use super::shared::Shared;
use crate::failure::Failure;
use axum::body::Body;
use axum::extract::{Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use serde::Deserialize;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::NamedTempFile;

/// Where they are kept, in the folder.
const STEM: &str = "upload";
/// What file systems take, less what a temporary file's name needs.
const NAME_BYTES_MAX: usize = 200;
/// Some hundred million rows: more than anything else here would hold.
const FILE_BYTES_MAX: u64 = 4 << 30;

/// `POST /api/uploads`: a folder for files that belong together.
pub async fn open(State(shared): State<Arc<Shared>>) -> Response {
    match opening(&mut shared.session()) {
        Ok(number) => json(&serde_json::json!({ "upload": number })),
        Err(refusal) => refusal.into_response(),
    }
}

fn opening(session: &mut Session) -> Result<u64, Refusal> {
    session.idle()?;
    let folder = places::new_folder(&session.folder, STEM)?;
    let number = number(&folder).ok_or_else(|| Failure::new("no number for an upload"))?;
    session.uploads.push(folder);
    Ok(number)
}

fn number(folder: &Path) -> Option<u64> {
    folder.file_name()?.to_str()?.strip_prefix(STEM)?.strip_prefix('-')?.parse().ok()
}

/// The folder of an upload that takes files still.
pub fn opened(session: &Session, upload: u64) -> Result<PathBuf, Failure> {
    let found = session.uploads.iter().find(|folder| number(folder) == Some(upload));
    found
        .cloned()
        .ok_or_else(|| Failure::new("there is no such upload, or it was read already").help("drop the files again"))
}

/// `?upload=1&name=campaign.csv`
#[derive(Deserialize)]
pub struct Named {
    upload: u64,
    name: String,
}

/// `POST /api/upload?upload=1&name=campaign.csv`
pub async fn receive(
    State(shared): State<Arc<Shared>>,
    Query(Named { upload, name }): Query<Named>,
    headers: HeaderMap,
    body: Body,
) -> Response {
    let folder = opened(&shared.session(), upload);
    let path = match folder.and_then(|folder| path(&folder, &name)) {
        Ok(path) => path,
        Err(failure) => return Refusal::from(failure).into_response(),
    };
    let announced = headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse().ok());
    match write(&path, announced.unwrap_or_default(), body).await {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(failure) => Refusal::from(failure).into_response(),
    }
}

/// Where the upload of this name is kept.
pub fn path(folder: &Path, name: &str) -> Result<PathBuf, Failure> {
    let plain = |c: char| !c.is_control() && !"/\\:*?\"<>|".contains(c);
    if name.len() > NAME_BYTES_MAX {
        let start: String = name.chars().take(40).collect();
        return Err(Failure::new(format_args!("`{start}…` is too long for a file's name"))
            .help(format_args!("give it one of at most {NAME_BYTES_MAX} letters and drop it again")));
    }
    if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
        return Err(Failure::new(format_args!("{name:?} is no name for a file")).help("rename it and drop it again"));
    }
    Ok(folder.join(name))
}

/// Whole or not at all, and over nothing that is there.
async fn write(path: &Path, announced: u64, body: Body) -> Result<(), Failure> {
    let io = |error: std::io::Error| Failure::io(path, &error);
    let room = |bytes: u64| if bytes > FILE_BYTES_MAX { Err(too_large(path)) } else { Ok(()) };
    room(announced)?;
    if places::is_taken(path) {
        return Err(there_already(path));
    }
    let mut file = NamedTempFile::with_prefix_in(".tempco-", path.parent().unwrap_or(Path::new("."))).map_err(io)?;
    let mut received = 0;
    let mut parts = body.into_data_stream();
    while let Some(part) = parts.next().await {
        let part = part.map_err(Failure::new)?;
        received += part.len() as u64;
        room(received)?;
        file.write_all(&part).map_err(io)?;
    }
    file.as_file().sync_all().map_err(io)?;
    file.persist_noclobber(path).map_err(|error| match error.error.kind() {
        std::io::ErrorKind::AlreadyExists => there_already(path),
        _ => io(error.error),
    })?;
    Ok(())
}

fn there_already(path: &Path) -> Failure {
    Failure::new(format_args!("{}: there is a file of this name already", path.display()))
        .help("rename one of the two and drop both again")
}

fn too_large(path: &Path) -> Failure {
    Failure::new(format_args!("{}: larger than {} GiB", path.display(), FILE_BYTES_MAX >> 30))
        .help("divide it into files of some runs each, or name it when you start `tempco workbench`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leads_out_of_the_folder() {
        let folder = Path::new("work/upload-1");
        assert_eq!(path(folder, "campaign 2.csv").expect("plain"), Path::new("work/upload-1/campaign 2.csv"));
        let long = "x".repeat(5000);
        for name in ["", ".", "..", "../a.csv", "a/b.csv", "C:\\a.csv", "/etc/passwd", ".hidden", "a\nb.csv", &long] {
            let refused = path(folder, name).expect_err(name).to_string();
            assert!(refused.len() < 300 && !refused.contains("a\nb"), "{refused}");
        }
    }

    #[test]
    fn an_upload_is_known_by_the_number_of_its_folder() {
        assert_eq!(number(Path::new("work/upload-12")), Some(12));
        assert_eq!(number(Path::new("work/demo-1")), None);
    }
}
