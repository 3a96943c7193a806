//! Held-out residuals without training again: each run predicted by what all the others teach.
//!
//! Least squares adds up run by run, so leaving one out is a subtraction: instrument and effects' parameters are
//! solved anew from the other runs' share of the normal equations and applied to the run that was left out.

use super::case::Case;
use super::case::Noises;
use super::evidence::product;
use super::instrument::Known;
use super::whitening::Columns;
use nalgebra::{Cholesky, DMatrix};

/// What is read wrong when each run is predicted from the others.
pub(super) struct HeldOut {
    /// RMS over all samples, µg.
    pub residual_ug: f64,
    /// Sum of squares of the whitened residuals: −2 log likelihood but for a constant.
    pub deviance: f64,
}

impl Case<'_> {
    /// Predicts each run from all the others.
    pub fn held_out(&self, known: &Known, noises: &Noises) -> HeldOut {
        let (left, freedom) = (self.left(known).delta, self.adapting(known).delta);
        let white_left = noises.delta.whiten(&self.layout, &left).columns;
        let white_freedom = noises.delta.whiten(&self.layout, &freedom).columns;
        let of = |matrix: &Columns, run: usize| vec![matrix[run].clone()];
        let mut normal = product(&white_freedom, &white_freedom);
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
        let right = product(&white_freedom, &white_left);
        let (mut squares, mut samples, mut deviance) = (0.0, 0.0, 0.0);
        for (run, stretch) in self.layout.stretches.iter().enumerate() {
            let own = of(&white_freedom, run);
            let others = &normal - product(&own, &own);
            let rest = &right - product(&own, &of(&white_left, run));
            let Some(factor) = Cholesky::new(others) else { continue };
            let learnt = factor.solve(&rest);
            let predicted: DMatrix<f64> = &left[run] - &freedom[run] * &learnt;
            for (cell, residual) in stretch.cells.iter().zip(predicted.iter()) {
                squares += cell.samples * residual.powi(2) + (cell.samples - 1.0) * self.sample_ug.powi(2);
                samples += cell.samples;
            }
            deviance += (&white_left[run] - &white_freedom[run] * &learnt).norm_squared();
        }
        HeldOut { residual_ug: if samples > 0.0 { (squares / samples).sqrt() } else { 0.0 }, deviance }
    }
}
