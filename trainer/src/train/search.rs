//! What a method of training comes back with.

use crate::fit::effects::Coefficients;
use protocol::Weights;

/// One training from one start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// RMS residual on the training data, g; before the best are trained on.
    pub residual_g: f64,
    /// Iterations made.
    pub iterations: usize,
    /// Whether it ended because nothing was left to gain, and not at a limit.
    pub converged: bool,
}

/// What a restart of any method ends with.
pub(super) struct Candidate {
    pub restart: Restart,
    pub cost: f64,
    pub line_g: [f64; 4],
    pub output_g: f64,
    pub weights: Weights,
    pub coefficients: Coefficients,
}

/// What a method found.
pub(super) struct Search {
    pub restarts: Vec<Restart>,
    pub best: Option<Candidate>,
}

impl Search {
    /// The restart of least cost; the first of equals, so that the number of threads doesn't matter.
    pub(super) fn of(candidates: Vec<Candidate>) -> Self {
        let restarts = candidates.iter().map(|candidate| candidate.restart).collect();
        Self { restarts, best: candidates.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost)) }
    }
}
