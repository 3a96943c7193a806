//! Held-out residuals without training again: each run predicted by what all the others teach.
//!
//! Least squares adds up run by run, so leaving one out is a subtraction: instrument and effects' parameters are
//! solved anew from the other runs' share of the normal equations and applied to the run that was left out.

use crate::diagnose::cells::{Cell, Columns, RunCells, product, stacked};
use crate::diagnose::forward::EffectSet;
use crate::diagnose::noise::{InitialStates, Shares, Whitening};
use crate::diagnose::problem::{NoiseModels, Problem, fixed};
use crate::diagnose::thresholds::{FEW_RUNS, LEAST_OF_ITS_OWN, PARTS_OF_FEW};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::Range;

/// What is read wrong when each run is predicted from the others.
pub struct HeldOut {
    /// RMS over all samples, µg.
    pub residual_ug: f64,
    /// The same without what is each part's own, µg: its offset, what follows the acceleration across the input axis, and
    /// what effects brought along, as they are new at every start and in every mounting.
    pub predictable_ug: f64,
    /// Sum of squares of the whitened residuals: −2 log likelihood but for a constant.
    pub deviance: f64,
    /// How many parts were left out, one after the other.
    pub parts: usize,
    /// Whether a part is a whole run, with an offset of its own.
    pub whole_runs: bool,
}

impl HeldOut {
    /// The residual without what no model can predict, µg: a run's own offset, mounting and initial states.
    pub fn structure_ug(&self) -> f64 {
        if self.whole_runs { self.predictable_ug } else { self.residual_ug }
    }
}

/// Predicts each run from all the others.
pub fn held_out(problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> HeldOut {
    let (residual, nuisance) = (problem.forward.residuals(set).delta, recalling(problem, set));
    let whitening = Whitening::new(problem.cells(), &noises.initial, &noises.delta);
    let (white_residual, white_nuisance) = (whitening.of(&residual), whitening.of(&nuisance));
    let mut normal = product(&white_nuisance, &white_nuisance);
    (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
    let right = product(&white_nuisance, &white_residual);
    let (mut squares, mut own, mut samples, mut deviance) = (0.0, 0.0, 0.0, 0.0);
    let folds = folds(problem);
    let (parts, whole_runs) = (folds.len(), problem.cells().runs.len() >= FEW_RUNS);
    for (run, rows) in folds {
        let part = |matrix: &Columns| matrix[run].rows(rows.start, rows.len()).into_owned();
        let here = vec![part(&white_nuisance)];
        let others = &normal - product(&here, &here);
        let rest = &right - product(&here, &vec![part(&white_residual)]);
        let Some(factor) = Cholesky::new(others) else { continue };
        let learnt = factor.solve(&rest);
        let predicted: DMatrix<f64> = part(&residual) - part(&nuisance) * &learnt;
        let cells = &problem.cells().runs[run].cells[rows.clone()];
        for (cell, residual) in cells.iter().zip(predicted.iter()) {
            squares += cell.samples * residual.powi(2) + (cell.samples - 1.0) * problem.sample_ug.powi(2);
            samples += cell.samples;
        }
        own += squares_of_its_own(cells, &predicted, &begun(&noises.initial, run, rows.clone()));
        deviance += (part(&white_residual) - &here[0] * &learnt).norm_squared();
    }
    let rms = |squares: f64| if samples > 0.0 { (squares.max(0.0) / samples).sqrt() } else { 0.0 };
    HeldOut { residual_ug: rms(squares), predictable_ug: rms(squares - own), deviance, parts, whole_runs }
}

/// What may adapt where something is left out: the map, and the effects' parameters about as far as they
/// could be known beforehand. What alone determines a parameter must not leave it at the mercy of noise.
/// µg: of each run cells × (map's directions + free parameters).
pub fn recalling(problem: &Problem, set: &EffectSet) -> Columns {
    let map = fixed(problem, set).delta;
    if set.effects.is_empty() {
        return map;
    }
    let forward = &problem.forward;
    let mut derivatives = forward.jacobian(forward.no_effects(), set, &forward.residuals(set)).delta;
    let reaches = set.reaches();
    for run in &mut derivatives {
        run.column_iter_mut().zip(&reaches).for_each(|(mut column, reach)| column *= *reach);
    }
    stacked(&map, &derivatives)
}

/// What is left out together: a run, or a stretch of a run where there are too few of them.
fn folds(problem: &Problem) -> Vec<(usize, Range<usize>)> {
    let runs = problem.cells().runs.len();
    let parts = if runs < FEW_RUNS { PARTS_OF_FEW.div_ceil(runs.max(1)) } else { 1 };
    let of = |(index, run): (usize, &RunCells)| {
        let cells = run.cells.len();
        let bounds = move |part: usize| cells * part / parts;
        (0..parts).map(move |part| (index, bounds(part)..bounds(part + 1))).collect::<Vec<_>>()
    };
    problem.cells().runs.iter().enumerate().flat_map(of).collect()
}

/// What is left of each initial state in these cells of a run.
fn begun(initial: &InitialStates, run: usize, rows: Range<usize>) -> Vec<Vec<f64>> {
    let shares: &[Shares] = initial.of_run(run);
    let of = |&(place, way): &(usize, usize)| rows.clone().map(|row| shares[row][place][way]).collect();
    initial.present().iter().map(of).collect()
}

/// How much of the sum of squares an offset takes up, a slope over the acceleration across the input axis, and what is
/// left of these initial states.
fn squares_of_its_own(cells: &[Cell], residual: &DMatrix<f64>, begun: &[Vec<f64>]) -> f64 {
    let weighted = |value: &dyn Fn(usize) -> f64| {
        DVector::from_fn(cells.len(), |index, _| cells[index].samples.sqrt() * value(index))
    };
    let rig = [weighted(&|_| 1.0), weighted(&|index| cells[index].cross_g)];
    let begun = begun.iter().map(|share| weighted(&|index| share[index]));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Moment, Recipe, dense, disturbed, effect, problem, white};

    const CELLS: usize = 20;

    fn cell(index: usize, cross_g: f64) -> Cell {
        Cell { samples: 1.0 + (index % 3) as f64, cross_g, ..Cell::plain(index, index as f64, 1.0) }
    }

    #[test]
    fn an_offset_a_tilt_and_an_initial_state_are_a_runs_own_and_a_tilt_of_what_was_never_turned_is_an_offset() {
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
        let begun: Vec<f64> = (0..CELLS).map(|index| (-(index as f64) / 3.0).exp()).collect();
        let fading = DMatrix::from_fn(CELLS, 1, |row, _| 80.0 * begun[row] + 7.0);
        let share = |begun: &[Vec<f64>]| {
            let all: f64 = still.iter().zip(fading.iter()).map(|(cell, value)| cell.samples * value * value).sum();
            squares_of_its_own(&still, &fading, begun) / all
        };
        let (with, without) = (share(&[begun]), share(&[]));
        assert!((with - 1.0).abs() < 1e-9 && without < 0.7, "{with} {without}");
    }

    fn white_rows(problem: &Problem, runs: impl Iterator<Item = usize>, columns: &Columns) -> DMatrix<f64> {
        let whiten = |run: usize| {
            let cells = &problem.cells().runs[run].cells;
            let sigma = |cell: &Cell| (25.0 / cell.samples + (problem.ug_per_c * cell.unseen_c).powi(2)).sqrt();
            DMatrix::from_fn(cells.len(), columns[run].ncols(), |row, column| {
                columns[run][(row, column)] / sigma(&cells[row])
            })
        };
        dense(&runs.map(whiten).collect::<Vec<_>>())
    }

    #[test]
    fn what_is_held_out_is_what_a_fit_to_the_other_runs_leaves() {
        let still = Recipe::default().campaign();
        let truth = EffectSet::NONE.with(&effect("warm-up", &still), &[2e-4, 500.0]);
        let campaign = disturbed(still, &truth);
        let problem = problem(&campaign);
        let set = EffectSet::NONE.with(&truth.effects[0], &[1.5e-4, 700.0]);
        let noises = white(&problem, &set, 5.0);
        let found = held_out(&problem, &set, &noises);
        let (residual, columns) = (problem.forward.residuals(&set).delta, recalling(&problem, &set));
        let (mut squares, mut samples, mut deviance) = (0.0, 0.0, 0.0);
        for run in 0..4 {
            let others = || (0..4).filter(move |other| *other != run);
            let (z, y) = (white_rows(&problem, others(), &columns), white_rows(&problem, others(), &residual));
            let prior = DMatrix::identity(z.ncols(), z.ncols());
            let learnt = (z.transpose() * &z + prior).lu().solve(&(z.transpose() * y)).unwrap();
            let left = &residual[run] - &columns[run] * learnt;
            let cells = &problem.cells().runs[run].cells;
            for (cell, value) in cells.iter().zip(left.iter()) {
                squares += cell.samples * value * value + (cell.samples - 1.0) * problem.sample_ug.powi(2);
                samples += cell.samples;
            }
            let mut whole = residual.clone();
            whole[run] = left;
            deviance += white_rows(&problem, std::iter::once(run), &whole).norm_squared();
        }
        let worked_ug = f64::sqrt(squares / samples);
        assert!((found.residual_ug / worked_ug - 1.0).abs() < 1e-6, "{} {worked_ug}", found.residual_ug);
        assert!((found.deviance / deviance - 1.0).abs() < 1e-6, "{} {deviance}", found.deviance);
        assert_eq!((found.parts, found.whole_runs), (4, true));
        // With the effect's parameters free the others teach what it does in this one; without it nobody does.
        let without = held_out(&problem, &EffectSet::NONE, &noises);
        assert!(found.residual_ug < 10.0 && without.residual_ug > 3.0 * found.residual_ug, "{}", without.residual_ug);
    }

    #[test]
    fn a_runs_own_offset_is_not_predictable_and_of_few_runs_parts_are_left_out() {
        let bias_g = |moment: &Moment| [80e-6, -60e-6, 30e-6, -50e-6][moment.run];
        let campaign = Recipe { bias_g: &bias_g, ..Recipe::default() }.campaign();
        let whole = problem(&campaign);
        let found = held_out(&whole, &EffectSet::NONE, &white(&whole, &EffectSet::NONE, 5.0));
        assert!(
            found.residual_ug > 40.0 && found.predictable_ug < 0.3 * found.residual_ug,
            "{} {}",
            found.residual_ug,
            found.predictable_ug
        );
        assert!((found.structure_ug() - found.predictable_ug).abs() < 1e-12);
        let campaign = Recipe { runs: 2, bias_g: &bias_g, ..Recipe::default() }.campaign();
        let few = problem(&campaign);
        let folds = folds(&few);
        assert_eq!(folds.len(), PARTS_OF_FEW);
        let covered: usize = folds.iter().map(|(_, rows)| rows.len()).sum();
        assert_eq!(covered, few.cells().len());
        let found = held_out(&few, &EffectSet::NONE, &white(&few, &EffectSet::NONE, 5.0));
        assert!(!found.whole_runs && (found.structure_ug() - found.residual_ug).abs() < 1e-12);
    }
}
