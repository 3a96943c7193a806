//! PLACEHOLDER on this branch only; the real module replaces it.

mod answer;

pub use answer::{Dependence, Diagnosis, Estimate, Finding, Noise, Unexplained, Unobservable, Verdict};

use crate::campaign::Campaign;
use crate::model::Model;
use crate::progress::Progress;
use thiserror::Error;

/// Why there is no diagnosis.
#[derive(Debug, Error)]
pub enum DiagnoseError {
    /// Stopped.
    #[error("cancelled")]
    Cancelled,
}

/// Which physical effects `model` lacks, as far as `campaign` can tell.
pub fn diagnose(_model: &Model, _campaign: &Campaign, _progress: &dyn Progress) -> Result<Diagnosis, DiagnoseError> {
    Err(DiagnoseError::Cancelled)
}
