//! One campaign and one model before the judge: what is measured, and what retraining could make of the model.

mod carried;
mod gauss_newton;
mod gls_pair;
mod noise_estimate;
mod noise_models;
mod nuisance;
mod setup;

pub(super) use carried::{ROUNDS, carried, rescaled};
pub(super) use gauss_newton::fit;
pub(super) use gls_pair::GlsPair;
pub(super) use noise_estimate::{estimate, refine, sum_noise};
pub(super) use noise_models::{NoiseModels, initial_states};
pub(super) use nuisance::{Nuisance, constrained, fixed, free, widened};
pub(super) use setup::{in_model, problem, scale, yardstick};

use super::cells::{Cells, Columns};
use super::forward::{Forward, Inputs};
use nalgebra::DMatrix;

/// The measurements, the static map, and what retraining can make of it. It never changes.
#[derive(Clone)]
pub(super) struct Problem<'a> {
    /// The measurements and what is taken for their cause.
    pub forward: Forward<'a>,
    /// What retraining can absorb, µg per expected change: of each run cells × p, a column a direction.
    pub basis: Columns,
    /// Its directions among all functions that might be added to the map: a row a function, a column a direction.
    directions: DMatrix<f64>,
    /// Noise of a sample, µg.
    pub sample_ug: f64,
    /// The reading's slope over temperature, µg/°C.
    pub ug_per_c: f64,
    /// Where effects move the inputs at which [`basis`](Self::basis) was taken.
    inputs: Inputs,
    /// Of each run, whether training never saw it; none where it saw all of them or none.
    pub unseen: Option<Vec<bool>>,
}

impl<'a> Problem<'a> {
    /// The cells.
    pub fn cells(&self) -> &Cells<'a> {
        &self.forward.cells
    }

    /// The same problem with the map as it was trained.
    pub fn as_trained(&self) -> Self {
        let mut plain = self.clone();
        plain.forward = self.forward.with_map(self.forward.map.as_trained());
        plain
    }

    /// What each parameter costs in −2 log likelihood: the logarithm of the number of cells (BIC; Schwarz 1978).
    pub fn parameter_cost(&self) -> f64 {
        (self.cells().len() as f64).ln()
    }
}
