//! Files that are dropped on the page. They are kept in the folder under their own names: errors name them, and so does
//! every command line.

use super::bench::{Bench, Refusal};
use crate::failure::Failure;
use axum::body::Body;
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use serde::Deserialize;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where they are kept, in the folder.
const FOLDER: &str = "uploads";

/// `?name=campaign.csv`
#[derive(Deserialize)]
pub struct Named {
    name: String,
}

/// `POST /api/upload?name=campaign.csv`
pub async fn receive(State(bench): State<Arc<Bench>>, Query(Named { name }): Query<Named>, body: Body) -> Response {
    let folder = bench.session().folder.clone();
    let path = match path(&folder, &name) {
        Ok(path) => path,
        Err(failure) => return Refusal::from(failure).into_response(),
    };
    match write(&path, body).await {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(failure) => Refusal::from(failure).into_response(),
    }
}

/// Where the upload of this name is kept.
pub fn path(folder: &Path, name: &str) -> Result<PathBuf, Failure> {
    let plain = |c: char| !c.is_control() && !"/\\:*?\"<>|".contains(c);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
        return Err(Failure::new(format_args!("`{name}` is no name for a file")).help("rename it and drop it again"));
    }
    Ok(folder.join(FOLDER).join(name))
}

async fn write(path: &Path, body: Body) -> Result<(), Failure> {
    let io = |error: std::io::Error| Failure::io(path, &error);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(io)?;
    }
    let mut file = File::create(path).map_err(io)?;
    let mut parts = body.into_data_stream();
    while let Some(part) = parts.next().await {
        file.write_all(&part.map_err(Failure::new)?).map_err(io)?;
    }
    file.flush().map_err(io)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leads_out_of_the_folder() {
        let folder = Path::new("work");
        assert_eq!(path(folder, "campaign 2.csv").expect("plain"), Path::new("work/uploads/campaign 2.csv"));
        for name in ["", ".", "..", "../a.csv", "a/b.csv", "C:\\a.csv", "/etc/passwd", ".hidden", "a\nb.csv"] {
            assert!(path(folder, name).is_err(), "{name}");
        }
    }
}
