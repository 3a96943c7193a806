//! The samples.
use super::bench::Bench;
use axum::extract::State;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;
pub async fn answer(State(_bench): State<Arc<Bench>>) -> Response {
    "".into_response()
}
