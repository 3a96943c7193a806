//! The samples of one or two models, for the linked plots.

use super::entry::Entry;
use super::json::json;
use super::refusal::Refusal;
use super::session::Session;
use super::shared::Shared;
use super::verb::{entry, measured};
use axum::body::Bytes;
use axum::extract::{Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::json;
use std::sync::Arc;
use trainer::campaign::Campaign;
use trainer::linked::{COLUMNS, Columns, Range};

/// More marks than this can't be told apart, and would make a brush slow.
const MOST: usize = 50_000;

/// `?models=1,2`
#[derive(Deserialize)]
pub struct Wanted {
    models: String,
}

/// What is needed of the session, to be looked at without holding it.
struct Looked {
    campaign: Arc<Campaign>,
    columns: Arc<Columns>,
    residuals_ug: Vec<Arc<Vec<f32>>>,
    /// Of the first model: name, kind and whether it is held out, run by run.
    runs: Vec<(String, String, bool)>,
}

impl Looked {
    fn at(session: &Session, numbers: &[usize]) -> Result<Self, Refusal> {
        let campaign = Arc::clone(&measured(session)?.campaign);
        let entries: Vec<&Entry> =
            numbers.iter().map(|number| entry(session, *number)).collect::<Result<_, Refusal>>()?;
        let first = entries.first().ok_or_else(|| super::verb::missing("no model is named", "name one: ?models=1"))?;
        let runs = first.comparison.runs.iter().map(|run| (run.run.clone(), run.kind.clone(), run.held_out)).collect();
        let residuals_ug = entries.iter().map(|entry| Arc::clone(&entry.residuals_ug)).collect();
        Ok(Self { campaign, columns: Arc::clone(&first.columns), residuals_ug, runs })
    }

    fn residuals(&self) -> Vec<&[f32]> {
        self.residuals_ug.iter().map(|residuals| residuals.as_slice()).collect()
    }
}

/// `GET /api/samples?models=1,2`: the length of a JSON header, the header, then columns of 32-bit numbers, little-endian.
pub async fn answer(State(shared): State<Arc<Shared>>, Query(Wanted { models }): Query<Wanted>) -> Response {
    let numbers: Vec<usize> = models.split(',').filter_map(|number| number.parse().ok()).collect();
    let looked = Looked::at(&shared.session(), &numbers);
    match tokio::task::spawn_blocking(move || looked.map(|looked| table(&looked, &numbers))).await {
        Ok(Ok(bytes)) => ([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response(),
        Ok(Err(refusal)) => refusal.into_response(),
        Err(error) => (StatusCode::INTERNAL_SERVER_ERROR, error.to_string()).into_response(),
    }
}

fn table(looked: &Looked, numbers: &[usize]) -> Vec<u8> {
    let residuals = looked.residuals();
    let (kept, stride) = looked.columns.drawn(&residuals, MOST);
    let runs = looked.runs.iter().zip(&looked.columns.places).map(|((name, kind, held_out), place)| {
        json!({ "name": name, "kind": kind, "held_out": held_out, "from_h": place.from_h, "to_h": place.to_h })
    });
    let head = json!({
        "rows": looked.columns.len(), "kept": kept.len(), "stride": stride, "columns": COLUMNS, "models": numbers,
        "runs": runs.collect::<Vec<_>>(),
    });
    let mut head = head.to_string();
    // Columns of 32-bit numbers begin at a multiple of four.
    head.extend(std::iter::repeat_n(' ', head.len().next_multiple_of(4) - head.len()));
    let mut bytes = (head.len() as u32).to_le_bytes().to_vec();
    bytes.extend(head.into_bytes());
    for column in looked.columns.values.iter().map(Vec::as_slice).chain(residuals) {
        bytes.extend(kept.iter().flat_map(|row| column[*row].to_le_bytes()));
    }
    bytes
}

/// Ranges of columns, and whether only held-out runs count or only the others.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Choice {
    models: Vec<usize>,
    ranges: Vec<Range>,
    #[serde(default)]
    held_out: Option<bool>,
}

/// `POST /api/chosen`: what a choice among all samples, drawn or not, amounts to.
pub async fn chosen(State(shared): State<Arc<Shared>>, body: Bytes) -> Response {
    let choice: Choice = match serde_json::from_slice(&body) {
        Ok(choice) => choice,
        Err(error) => return (StatusCode::BAD_REQUEST, error.to_string()).into_response(),
    };
    let looked = Looked::at(&shared.session(), &choice.models);
    let counted = tokio::task::spawn_blocking(move || {
        let looked = looked?;
        let is =
            |name: &str| looked.runs.iter().any(|(run, _, held_out)| run == name && Some(*held_out) == choice.held_out);
        let wanted = |name: &str| choice.held_out.is_none() || is(name);
        Ok::<_, Refusal>(looked.columns.chosen(&looked.campaign, &looked.residuals(), &choice.ranges, wanted))
    });
    match counted.await {
        Ok(Ok(chosen)) => json(&chosen),
        Ok(Err(refusal)) => refusal.into_response(),
        Err(error) => (StatusCode::INTERNAL_SERVER_ERROR, error.to_string()).into_response(),
    }
}
