//! Why there is no recording.

use crate::scenario::ScenarioError;

/// Why there is no recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The scenario cannot be carried out.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// `progress` asked to stop.
    #[error("the simulation was stopped after {percent:.0} %")]
    Stopped {
        /// How much was done, percent.
        percent: f64,
    },
}
