//! Why a request is not carried out, as the page receives it.

use super::json::json;
use crate::failure::Failure;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};

/// Why a request is not carried out.
pub struct Refusal {
    pub status: StatusCode,
    pub failure: Failure,
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        Self { status: StatusCode::UNPROCESSABLE_ENTITY, failure }
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let mut response = json(&self.failure);
        *response.status_mut() = self.status;
        response
    }
}
