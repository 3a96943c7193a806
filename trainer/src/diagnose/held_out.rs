//! Held-out residuals without training again: each run predicted by what all the others teach.
//!
//! Least squares adds up run by run, so leaving one out is a subtraction: instrument and effects' parameters are
//! solved anew from the other runs' share of the normal equations and applied to the run that was left out.

use super::case::Case;
use super::case::Noises;
use super::evidence::{product, stacked};
use super::instrument::Known;
use super::layout::Cell;
use super::whitening::Columns;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::Range;

/// What is read wrong when each run is predicted from the others.
pub(super) struct HeldOut {
    /// RMS over all samples, µg.
    pub residual_ug: f64,
    /// The same without what is each part's own, µg: its offset, what follows the acceleration across the input axis, and
    /// what effects brought along, as they are new at every start and in every mounting.
    pub foreseeable_ug: f64,
    /// Sum of squares of the whitened residuals: −2 log likelihood but for a constant.
    pub deviance: f64,
    /// How many parts were left out, one after the other.
    pub parts: usize,
    /// Whether a part is a whole run, with an offset of its own.
    pub whole_runs: bool,
}

impl HeldOut {
    /// The residual without what no model can foretell, µg: a run's own offset, mounting and beginning.
    pub fn structure_ug(&self) -> f64 {
        if self.whole_runs { self.foreseeable_ug } else { self.residual_ug }
    }
}

impl Case<'_> {
    /// Predicts each run from all the others.
    pub fn held_out(&self, known: &Known, noises: &Noises) -> HeldOut {
        let (left, freedom) = (self.left(known).delta, self.recalling(known));
        let whitening = noises.delta.whitening(&self.layout);
        let (white_left, white_freedom) = (whitening.of(&left), whitening.of(&freedom));
        let mut normal = product(&white_freedom, &white_freedom);
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
        let right = product(&white_freedom, &white_left);
        let (mut squares, mut own, mut samples, mut deviance) = (0.0, 0.0, 0.0, 0.0);
        let folds = self.folds();
        let (parts, whole_runs) = (folds.len(), self.layout.stretches.len() >= FEW_RUNS);
        for (run, rows) in folds {
            let part = |matrix: &Columns| matrix[run].rows(rows.start, rows.len()).into_owned();
            let here = vec![part(&white_freedom)];
            let others = &normal - product(&here, &here);
            let rest = &right - product(&here, &vec![part(&white_left)]);
            let Some(factor) = Cholesky::new(others) else { continue };
            let learnt = factor.solve(&rest);
            let predicted: DMatrix<f64> = part(&left) - part(&freedom) * &learnt;
            let cells = &self.layout.stretches[run].cells[rows.clone()];
            for (cell, residual) in cells.iter().zip(predicted.iter()) {
                squares += cell.samples * residual.powi(2) + (cell.samples - 1.0) * self.sample_ug.powi(2);
                samples += cell.samples;
            }
            own += squares_of_its_own(cells, &predicted, &self.layout.remembered);
            deviance += (part(&white_left) - &here[0] * &learnt).norm_squared();
        }
        let rms = |squares: f64| if samples > 0.0 { (squares.max(0.0) / samples).sqrt() } else { 0.0 };
        HeldOut { residual_ug: rms(squares), foreseeable_ug: rms(squares - own), deviance, parts, whole_runs }
    }

    /// What may adapt where something is left out: the instrument, and the effects' parameters about as far as they
    /// could be known beforehand. What alone determines a parameter must not leave it at the mercy of noise.
    pub fn recalling(&self, known: &Known) -> Columns {
        let stiff = self.stiff(known).delta;
        if known.effects.is_empty() {
            return stiff;
        }
        let (mut tangents, _) = self.tangents(&self.bare, known, &self.left(known));
        let reaches = known.reaches();
        for run in &mut tangents {
            run.column_iter_mut().zip(&reaches).for_each(|(mut column, reach)| column *= *reach);
        }
        stacked(&stiff, &tangents)
    }

    /// What is left out together: a run, or a stretch of a run where there are too few of them.
    fn folds(&self) -> Vec<(usize, Range<usize>)> {
        let runs = self.layout.stretches.len();
        let parts = if runs < FEW_RUNS { PARTS_OF_FEW.div_ceil(runs.max(1)) } else { 1 };
        let of = |(run, stretch): (usize, &super::layout::Stretch)| {
            let cells = stretch.cells.len();
            let bounds = move |part: usize| cells * part / parts;
            (0..parts).map(move |part| (run, bounds(part)..bounds(part + 1))).collect::<Vec<_>>()
        };
        self.layout.stretches.iter().enumerate().flat_map(of).collect()
    }
}

/// How much of the sum of squares an offset takes up, a slope over the acceleration across the input axis, and what is
/// left of these beginnings.
fn squares_of_its_own(cells: &[Cell], residual: &DMatrix<f64>, remembered: &[(usize, usize)]) -> f64 {
    let weighted = |value: &dyn Fn(usize) -> f64| {
        DVector::from_fn(cells.len(), |index, _| cells[index].samples.sqrt() * value(index))
    };
    let rig = [weighted(&|_| 1.0), weighted(&|index| cells[index].cross_g)];
    let begun = remembered.iter().map(|&(place, end)| weighted(&|index| cells[index].beginnings[place][end]));
    let residual = weighted(&|index| residual[index]);
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for column in rig.into_iter().chain(begun) {
        let beyond = basis.iter().fold(column.clone(), |left, direction| &left - direction * direction.dot(&left));
        // Where the sensor was never turned, the mounting is part of the offset.
        if beyond.norm_squared() > LEAST_OF_ITS_OWN * column.norm_squared() {
            basis.push(beyond.normalize());
        }
    }
    basis.iter().map(|direction| direction.dot(&residual).powi(2)).sum()
}

/// What varies by less than this share of its square is part of what came before.
const LEAST_OF_ITS_OWN: f64 = 1e-4;

/// With fewer runs, parts of them are left out; so many parts in all.
const FEW_RUNS: usize = 3;
const PARTS_OF_FEW: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;

    const CELLS: usize = 20;

    fn cell(index: usize, cross_g: f64) -> Cell {
        Cell { samples: 1.0 + (index % 3) as f64, cross_g, ..Cell::plain(index, index as f64, 1.0) }
    }

    #[test]
    fn an_offset_a_tilt_and_a_beginning_are_a_runs_own_and_a_tilt_of_what_was_never_turned_is_an_offset() {
        let course = |cells: &[Cell]| DMatrix::from_fn(CELLS, 1, |row, _| 150.0 - 90.0 * cells[row].cross_g);
        let squares = |cells: &[Cell]| -> f64 {
            cells.iter().zip(course(cells).iter()).map(|(cell, value)| cell.samples * value * value).sum()
        };
        let turned: Vec<Cell> = (0..CELLS).map(|index| cell(index, index as f64 / 20.0)).collect();
        assert!((squares_of_its_own(&turned, &course(&turned), &[]) / squares(&turned) - 1.0).abs() < 1e-9);
        let still: Vec<Cell> = (0..CELLS).map(|index| cell(index, 1.0)).collect();
        assert!((squares_of_its_own(&still, &course(&still), &[]) / squares(&still) - 1.0).abs() < 1e-9);
        // What swings within the run is neither.
        let swing = DMatrix::from_fn(CELLS, 1, |row, _| if row % 2 == 0 { 10.0 } else { -10.0 });
        let all = 100.0 * turned.iter().map(|cell| cell.samples).sum::<f64>();
        assert!(squares_of_its_own(&turned, &swing, &[]) < 0.1 * all);
        // Nor is what fades, unless an effect is known that brought it along.
        let begun = |index: usize| Cell { beginnings: [[(-(index as f64) / 3.0).exp(), 0.0]; 4], ..cell(index, 1.0) };
        let begun: Vec<Cell> = (0..CELLS).map(begun).collect();
        let fading = DMatrix::from_fn(CELLS, 1, |row, _| 80.0 * begun[row].beginnings[1][0] + 7.0);
        let share = |remembered: &[(usize, usize)]| {
            let all: f64 = begun.iter().zip(fading.iter()).map(|(cell, value)| cell.samples * value * value).sum();
            squares_of_its_own(&begun, &fading, remembered) / all
        };
        assert!((share(&[(1, 0)]) - 1.0).abs() < 1e-9 && share(&[]) < 0.7, "{} {}", share(&[(1, 0)]), share(&[]));
    }
}
