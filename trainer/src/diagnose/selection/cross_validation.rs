//! Held-out residuals without training again: each run predicted by what all the others teach.
//!
//! Least squares adds up run by run, so leaving one out is a subtraction: instrument and effects' parameters are
//! solved anew from the other runs' share of the normal equations and applied to the run that was left out.

use crate::diagnose::cells::{Cell, Columns, RunCells, product, stacked};
use crate::diagnose::forward::EffectSet;
use crate::diagnose::noise::{InitialStates, Shares, Whitening};
use crate::diagnose::problem::{NoiseModels, Problem, ROUNDS, fixed, initial_states};
use crate::diagnose::thresholds::{FEW_RUNS, LEAST_OF_ITS_OWN, PARTS_OF_FEW};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::Range;

/// What is read wrong when each run is predicted from the others.
#[derive(Clone)]
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

/// Predicts each run from all the others, beginning with the map that training made.
pub fn held_out(problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> HeldOut {
    let whole_runs = problem.cells().runs.len() >= FEW_RUNS;
    HeldOut { whole_runs, ..left_out(problem, set, noises, folds(problem)) }
}

/// Predicts the runs that training never saw from those that it saw, beginning with the map that it made; where it saw all
/// or none of them, each run from all the others.
pub fn predicted(problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> HeldOut {
    let Some(unseen) = &problem.unseen else { return held_out(problem, set, noises) };
    let runs = problem.cells().runs.iter().enumerate().filter(|(index, _)| unseen[*index]);
    let fold = runs.map(|(index, run)| (index, 0..run.cells.len())).collect();
    HeldOut { whole_runs: true, ..left_out(problem, set, noises, vec![fold]) }
}

/// Parts of runs that are left out together: which run, and which of its cells.
type Fold = Vec<(usize, Range<usize>)>;

/// Each fold predicted from all others, beginning with the map that training made: what is expected of it and of
/// parameters is learnt so many times, each time from where it was found before.
fn left_out(problem: &Problem, set: &EffectSet, noises: &NoiseModels, folds: Vec<Fold>) -> HeldOut {
    let problem = &problem.as_trained();
    let (residual, nuisance) = (problem.forward.residuals(set).delta, recalling(problem, set));
    let whitening = Whitening::new(problem.cells(), &noises.initial, &noises.delta);
    let (white_residual, white_nuisance) = (whitening.of(&residual), whitening.of(&nuisance));
    let mut normal = product(&white_nuisance, &white_nuisance);
    (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
    let right = product(&white_nuisance, &white_residual);
    let mut sums = Sums::default();
    let parts = folds.len();
    for fold in folds {
        let part = |matrix: &Columns| -> Columns {
            fold.iter().map(|(run, rows)| matrix[*run].rows(rows.start, rows.len()).into_owned()).collect()
        };
        let (here, white) = (part(&white_nuisance), part(&white_residual));
        let Some(factor) = Cholesky::new(&normal - product(&here, &here)) else { continue };
        let first = factor.solve(&(&right - product(&here, &white)));
        let learnt = std::iter::successors(Some(first), |last| Some(factor.solve(last)));
        let learnt = learnt.take(ROUNDS).fold(DMatrix::zeros(normal.nrows(), 1), |sum, next| sum + next);
        for (index, (run, rows)) in fold.iter().enumerate() {
            let rows_of = |matrix: &Columns| matrix[*run].rows(rows.start, rows.len()).into_owned();
            let predicted = rows_of(&residual) - rows_of(&nuisance) * &learnt;
            let cells = &problem.cells().runs[*run].cells[rows.clone()];
            sums.add(cells, &predicted, &begun(&noises.initial, *run, rows.clone()), problem.sample_ug);
            sums.deviance += (&white[index] - &here[index] * &learnt).norm_squared();
        }
    }
    sums.held_out(parts)
}

/// What the model reads wrong as it is, in the runs that training never saw, or in all where it saw none of them; `None`
/// where it saw all of them.
pub fn as_it_is(problem: &Problem, set: &EffectSet, counts: &[bool]) -> Option<HeldOut> {
    let initial = initial_states(problem, set);
    let by_sample = problem.cells().by_sample();
    let (rows, cells) = (problem.forward.residual_in_ug(&by_sample, set), problem.forward.residuals(set).delta);
    let mut sums = Sums::default();
    let mut squares = 0.0;
    for index in (0..cells.len()).filter(|&index| counts[index]) {
        let all = 0..cells[index].nrows();
        let own = begun(&initial, index, all);
        sums.add(&problem.cells().runs[index].cells, &cells[index], &own, problem.sample_ug);
        squares += rows[index].norm_squared();
    }
    let runs = counts.iter().filter(|counts| **counts).count();
    let whole = HeldOut { whole_runs: true, ..sums.held_out(runs) };
    (sums.samples > 0.0).then(|| HeldOut { residual_ug: f64::sqrt(squares / sums.samples), ..whole })
}

/// Sums of squares over what was left out.
#[derive(Default)]
struct Sums {
    squares: f64,
    own: f64,
    samples: f64,
    deviance: f64,
}

impl Sums {
    /// These cells of a run, what is read wrong there, and what is left of its initial states.
    fn add(&mut self, cells: &[Cell], residual: &DMatrix<f64>, begun: &[Vec<f64>], sample_ug: f64) {
        for (cell, residual) in cells.iter().zip(residual.iter()) {
            self.squares += cell.samples * residual.powi(2) + (cell.samples - 1.0) * sample_ug.powi(2);
            self.samples += cell.samples;
        }
        self.own += squares_of_its_own(cells, residual, begun);
    }

    fn held_out(&self, parts: usize) -> HeldOut {
        let rms = |squares: f64| if self.samples > 0.0 { (squares.max(0.0) / self.samples).sqrt() } else { 0.0 };
        HeldOut {
            residual_ug: rms(self.squares),
            predictable_ug: rms(self.squares - self.own),
            deviance: self.deviance,
            parts,
            whole_runs: false,
        }
    }
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
fn folds(problem: &Problem) -> Vec<Fold> {
    let runs = problem.cells().runs.len();
    let parts = if runs < FEW_RUNS { PARTS_OF_FEW.div_ceil(runs.max(1)) } else { 1 };
    let of = |(index, run): (usize, &RunCells)| {
        let cells = run.cells.len();
        let bounds = move |part: usize| cells * part / parts;
        (0..parts).map(move |part| vec![(index, bounds(part)..bounds(part + 1))]).collect::<Vec<_>>()
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
    use crate::diagnose::example::{Moment, Recipe, dense, problem, warmed_up, white};

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
        let (campaign, truth) = warmed_up(&[2e-4, 500.0]);
        let problem = problem(&campaign);
        let set = EffectSet::NONE.with(&truth.effects[0], &[1.5e-4, 700.0]);
        let noises = white(&problem, &set, 5.0);
        let found = held_out(&problem, &set, &noises);
        let (residual, columns) = (problem.forward.residuals(&set).delta, recalling(&problem, &set));
        let (mut squares, mut samples, mut deviance) = (0.0, 0.0, 0.0);
        for run in 0..4 {
            let others = || (0..4).filter(move |other| *other != run);
            let (z, y) = (white_rows(&problem, others(), &columns), white_rows(&problem, others(), &residual));
            let normal = (z.transpose() * &z + DMatrix::identity(z.ncols(), z.ncols())).lu();
            // What is expected is learnt anew from where it was found.
            let mut learnt = DMatrix::zeros(z.ncols(), 1);
            for _ in 0..ROUNDS {
                learnt += normal.solve(&(z.transpose() * (&y - &z * &learnt))).unwrap();
            }
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
    fn runs_that_training_never_saw_are_predicted_from_those_that_it_saw() {
        let (campaign, truth) = warmed_up(&[2e-4, 500.0]);
        let mut problem = problem(&campaign);
        let (none, noises) = (EffectSet::NONE, white(&problem, &truth, 5.0));
        let all = predicted(&problem, &truth, &noises);
        assert_eq!(all.parts, 4, "where training saw all or none, each is left out");
        problem.unseen = Some(vec![false, false, true, false]);
        let found = predicted(&problem, &truth, &noises);
        assert_eq!((found.parts, found.whole_runs), (1, true));
        let third = problem.cells().runs[2].cells.iter().map(|cell| cell.samples).sum::<f64>();
        let as_it_is = |counts: &[bool], set: &EffectSet| as_it_is(&problem, set, counts);
        let [seen, unseen] =
            [&[true, true, false, true], &[false, false, true, false]].map(|counts| as_it_is(counts, &none).unwrap());
        assert!((unseen.deviance, seen.parts, unseen.parts) == (0.0, 3, 1) && third > 0.0);
        // The line reads the warm-up wrong and the noise with it; beside the effect 5 µg are left, predicted or not.
        let rms = |course: &DMatrix<f64>| (course.norm_squared() / course.nrows() as f64).sqrt();
        let by_sample = problem.forward.residual_in_ug(&problem.cells().by_sample(), &none);
        assert!((unseen.residual_ug / rms(&by_sample[2]) - 1.0).abs() < 1e-12);
        let right = as_it_is(&[false, false, true, false], &truth).unwrap();
        assert!(found.residual_ug < 6.0 && right.residual_ug < 6.0, "{} {}", found.residual_ug, right.residual_ug);
        assert!(unseen.residual_ug > 4.0 * right.residual_ug, "{}", unseen.residual_ug);
        assert!(as_it_is(&[false; 4], &none).is_none());
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
        let covered: usize = folds.iter().flatten().map(|(_, rows)| rows.len()).sum();
        assert_eq!(covered, few.cells().len());
        let found = held_out(&few, &EffectSet::NONE, &white(&few, &EffectSet::NONE, 5.0));
        assert!(!found.whole_runs && (found.structure_ug() - found.residual_ug).abs() < 1e-12);
    }
}
