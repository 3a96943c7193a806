//! Difference and sum of the frequencies side by side, under one noise.

use super::Problem;
use super::noise_models::NoiseModels;
use super::nuisance::Nuisance;
use crate::diagnose::cells::Columns;
use crate::diagnose::forward::CellResiduals;
use crate::diagnose::regression::Gls;
use nalgebra::DMatrix;

/// The regressions of difference and sum.
pub struct GlsPair {
    /// For the residual.
    pub delta: Gls,
    /// For the sum.
    pub sum: Option<Gls>,
}

impl GlsPair {
    /// Of what is left, under `noises`; `None` if the numbers are not finite.
    pub fn new(
        problem: &Problem,
        residuals: &CellResiduals,
        nuisance: &Nuisance,
        noises: &NoiseModels,
    ) -> Option<Self> {
        let gls = |noise, residual, nuisance| Gls::new(problem.cells(), &noises.initial, noise, residual, nuisance);
        let delta = gls(&noises.delta, &residuals.delta, &nuisance.delta)?;
        let sum = match (&residuals.sum, &nuisance.sum, &noises.sum) {
            (Some(sum), Some(nuisance), Some(noise)) => Some(gls(noise, sum, nuisance)?),
            _ => None,
        };
        Some(Self { delta, sum })
    }

    /// Products of columns with each other, beyond what map and noise absorb, difference (µg) and sum (mHz) together:
    /// of each run cells × k, of both k × k.
    pub fn normal(&self, delta: &Columns, sum: Option<&Columns>) -> DMatrix<f64> {
        let mut normal = self.delta.score(delta).normal;
        if let (Some(gls), Some(columns)) = (&self.sum, sum) {
            normal += gls.score(columns).normal;
        }
        normal
    }

    /// −2 log likelihood of difference and sum.
    pub fn deviance(&self) -> f64 {
        self.delta.deviance + self.sum.as_ref().map_or(0.0, |gls| gls.deviance)
    }
}
