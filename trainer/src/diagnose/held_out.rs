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

impl Case<'_> {
    /// RMS over all samples of what each run reads wrong when it is predicted from the others, µg.
    pub fn held_out_ug(&self, known: &Known, noises: &Noises) -> f64 {
        let (left, freedom) = (self.left(known).delta, self.adapting(known).delta);
        let white_left = noises.delta.whiten(&self.layout, &left).columns;
        let white_freedom = noises.delta.whiten(&self.layout, &freedom).columns;
        let of = |matrix: &Columns, run: usize| vec![matrix[run].clone()];
        let mut normal = product(&white_freedom, &white_freedom);
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
        let right = product(&white_freedom, &white_left);
        let (mut squares, mut samples) = (0.0, 0.0);
        for (run, stretch) in self.layout.stretches.iter().enumerate() {
            let own = of(&white_freedom, run);
            let others = &normal - product(&own, &own);
            let rest = &right - product(&own, &of(&white_left, run));
            let Some(factor) = Cholesky::new(others) else { continue };
            let predicted: DMatrix<f64> = &left[run] - &freedom[run] * factor.solve(&rest);
            for (cell, residual) in stretch.cells.iter().zip(predicted.iter()) {
                squares += cell.samples * residual.powi(2) + (cell.samples - 1.0) * self.sample_ug.powi(2);
                samples += cell.samples;
            }
        }
        if samples > 0.0 { (squares / samples).sqrt() } else { 0.0 }
    }
}
