//! One campaign and one model before the judge: what is measured, and what retraining could make of the model.

mod gauss_newton;
mod gls_pair;
mod noise_estimate;
mod noise_models;
mod nuisance;
mod setup;

pub(super) use gauss_newton::fit;
pub(super) use gls_pair::GlsPair;
pub(super) use noise_estimate::{estimate, refine, sum_noise};
pub(super) use noise_models::{NoiseModels, initial_states};
pub(super) use nuisance::{Nuisance, constrained, fixed, free, widened};
pub(super) use setup::{in_model, problem, scale, yardstick};

use super::cells::{Cells, Columns};
use super::forward::Forward;

/// The measurements, the static map, and what retraining can make of it. It never changes.
#[derive(Clone)]
pub(super) struct Problem<'a> {
    /// The measurements and what is taken for their cause.
    pub forward: Forward<'a>,
    /// What retraining can absorb, µg per expected change: of each run cells × p, a column a direction.
    pub basis: Columns,
    /// Noise of a sample, µg.
    pub sample_ug: f64,
    /// The reading's slope over temperature, µg/°C.
    pub ug_per_c: f64,
}

impl<'a> Problem<'a> {
    /// The cells.
    pub fn cells(&self) -> &Cells<'a> {
        &self.forward.cells
    }

    /// What each parameter costs in −2 log likelihood: the logarithm of the number of cells (BIC; Schwarz 1978).
    pub fn parameter_cost(&self) -> f64 {
        (self.cells().len() as f64).ln()
    }
}
