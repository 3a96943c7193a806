//! `tempco effects`

use crate::workbench::json::json;
use axum::response::Response;
use firmware_core::effect::{ALL, About, Parameter};
use serde_json::{Value, json};
use trainer::expression::{FUNCTIONS, NAMES};

/// `GET /api/effects`: every effect, and what an expression may say.
pub async fn answer() -> Response {
    json(&json!({
        "effects": ALL.iter().copied().map(effect).collect::<Vec<_>>(),
        "names": NAMES.iter().map(|(name, meaning, _)| json!([name, meaning])).collect::<Vec<_>>(),
        "functions": FUNCTIONS.iter().map(|(name, _)| name).collect::<Vec<_>>(),
    }))
}

fn effect(about: &About) -> Value {
    let parameter = |one: &Parameter| json!({ "name": one.name, "unit": one.unit, "low": one.low, "high": one.high });
    json!({
        "name": about.name,
        "summary": about.summary,
        "equation": about.equation,
        "source": about.source,
        "needs": about.needs,
        "channel": about.channel,
        "on_device": about.is_on_device(),
        "takes_expression": about.takes_program(),
        "parameters": about.parameters.iter().map(parameter).collect::<Vec<_>>(),
    })
}
