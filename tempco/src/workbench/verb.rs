//! What the page can ask for: one verb, one file. Each calls the function that its command calls.

pub mod campaign;
pub mod change;
pub mod demo;
pub mod diagnose;
pub mod effects;
pub mod export;
pub mod load;
pub mod plan;
pub mod reveal;
pub mod select;
pub mod split;
pub mod stop;
pub mod train;
pub mod verify;

use super::entry::Entry;
use super::measured::Measured;
use super::refusal::Refusal;
use super::session::Session;
use crate::failure::Failure;
use axum::http::StatusCode;
use serde::Deserialize;

/// A request about one model.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OfModel {
    model: usize,
}

pub fn measured(session: &Session) -> Result<&Measured, Refusal> {
    session.measured.as_ref().ok_or_else(|| missing("there is no campaign yet", "drop a CSV file on the page"))
}

pub fn entry(session: &Session, number: usize) -> Result<&Entry, Refusal> {
    let found = session.models.iter().find(|entry| entry.number == number);
    found.ok_or_else(|| missing("there is no such model", "train one first"))
}

pub fn missing(what: &str, help: &str) -> Refusal {
    Refusal { status: StatusCode::CONFLICT, failure: Failure::new(what).help(help) }
}
