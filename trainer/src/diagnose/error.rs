//! Why there is no diagnosis.

use crate::effect_choice::EffectError;
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
    /// The numbers lead nowhere.
    #[error("{0}")]
    Numbers(&'static str),
    /// The campaign lacks what the model's effects follow.
    #[error(transparent)]
    Effect(#[from] EffectError),
}
