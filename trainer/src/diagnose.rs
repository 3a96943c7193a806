//! Which physical effect is missing.

mod answer;
mod candidate;
mod case;
mod dependence;
mod distance;
mod evidence;
mod instrument;
mod held_out;
mod hypothesis;
mod layout;
mod noise_search;
mod observable;
mod period;
pub mod plan;
mod planned;
mod search;
mod separation;
mod sum_channel;
mod whitening;

pub use answer::{Dependence, Diagnosis, Estimate, Finding, Noise, Unexplained, Unobservable, Verdict};

mod judge;

use crate::campaign::Campaign;
use crate::model::Model;
use crate::progress::Progress;
use crate::train::TrainError;
use thiserror::Error;

/// Why there is no diagnosis.
#[derive(Debug, Error)]
pub enum DiagnoseError {
    /// Stopped.
    #[error("cancelled")]
    Cancelled,
    /// The residual's noise can't be told.
    #[error("the noise can't be told from these measurements: no two neighbouring rows share a position")]
    NoNoise,
    /// The campaign lacks what the model's effects follow.
    #[error(transparent)]
    Effect(#[from] TrainError),
}

/// Which physical effects `model` lacks, as far as `campaign` can tell.
///
/// # Errors
/// [`DiagnoseError`] says what is missing.
pub fn diagnose(model: &Model, campaign: &Campaign, progress: &dyn Progress) -> Result<Diagnosis, DiagnoseError> {
    judge::judge(model, campaign, progress)
}
