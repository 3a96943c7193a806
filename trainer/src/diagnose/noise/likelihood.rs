//! The likelihood of columns under a noise, and the columns with the noise's correlation taken out.

use super::components::{Component, NoiseModel};
use super::initial_state::InitialStates;
use super::kalman::{self, Pass, State};
use super::observation::{Kind, Observed};
use crate::diagnose::cells::{Cells, Columns, SLOWEST};
use crate::diagnose::thresholds::LEAST_STATE;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// A noise on its way through all runs, ready for any column.
pub struct Whitening {
    passes: Vec<Box<dyn Pass>>,
    /// Logarithm of the determinant of the noise's covariance.
    pub log_det: f64,
}

impl Whitening {
    /// What takes the noise's correlation out of columns.
    pub fn new(cells: &Cells, initial: &InitialStates, noise: &NoiseModel) -> Self {
        let states = states(noise, initial);
        let pass = |run| kalman::pass(noise, &states, run);
        let passes: Vec<_> = observed(cells, initial).into_par_iter().map(pass).collect();
        let log_det = passes.iter().map(|pass| pass.log_det()).sum();
        Self { passes, log_det }
    }

    /// The columns with the noise's correlation taken out: white with variance one. Of each run cells × k in the
    /// noise's unit (µg or mHz), and the same without a unit.
    pub fn of(&self, columns: &Columns) -> Columns {
        let pairs: Vec<_> = self.passes.iter().zip(columns).collect();
        pairs.into_par_iter().map(|(pass, values)| pass.whitened(values)).collect()
    }

    /// The same of one run: cells of that run × k.
    pub fn of_run(&self, run: usize, columns: &DMatrix<f64>) -> DMatrix<f64> {
        self.passes[run].whitened(columns)
    }
}

/// Minus twice the logarithm of the likelihood of one column, but for a constant: of each run cells × 1, in the noise's
/// unit.
pub fn deviance(cells: &Cells, initial: &InitialStates, noise: &NoiseModel, column: &Columns) -> f64 {
    let states = states(noise, initial);
    let mut runs: Vec<_> = observed(cells, initial).into_iter().zip(column.iter().map(DMatrix::as_slice)).collect();
    // Runs of like length go together.
    runs.sort_by_key(|(run, _)| std::cmp::Reverse(run.len()));
    let some = runs.par_chunks(kalman::RUNS).map(|some| kalman::deviance(noise, &states, some));
    // Summed in order: the same on any number of threads.
    some.collect::<Vec<f64>>().iter().sum()
}

fn observed<'a>(cells: &'a Cells, initial: &'a InitialStates) -> Vec<Observed<'a>> {
    let runs = cells.runs.iter().enumerate();
    runs.map(|(index, run)| Observed { run, initial: initial.of_run(index) }).collect()
}

/// The states that make a difference.
fn states(noise: &NoiseModel, initial: &InitialStates) -> Vec<State> {
    let all = Component::ALL.into_iter().flat_map(|component| {
        let states = kinds(component, initial).into_iter();
        states.map(move |kind| (kind, noise[component], component.unit(1.0)))
    });
    let matters = |&(_, size, unit): &(Kind, f64, f64)| size / unit > noise.sample * LEAST_STATE;
    all.filter(matters).map(|(kind, size, _)| State { kind, variance: size * size }).collect()
}

/// The states that a part of the noise consists of: all have its size.
fn kinds(component: Component, initial: &InitialStates) -> Vec<Kind> {
    match component {
        Component::Run => vec![Kind::Constant],
        Component::Mounting => vec![Kind::Mounting],
        Component::Position => vec![Kind::Position],
        Component::Node => vec![Kind::Node],
        // Two octaves make it as good as 1/f.
        Component::Flicker => vec![Kind::Fading(0), Kind::Fading(1)],
        Component::Wander => vec![Kind::Fading(SLOWEST)],
        Component::Walk => vec![Kind::Walk],
        Component::Pose => vec![Kind::Pose],
        Component::Turn => vec![Kind::Turning],
        Component::Initial(effect) => {
            let own = initial.present().iter().filter(|(place, _)| *place == effect);
            own.map(|&(place, way)| Kind::Initial(place, way)).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::initial_state::PLACES;
    use super::*;
    use crate::diagnose::example::{Recipe, effect, problem};
    use crate::diagnose::forward::EffectSet;

    #[test]
    fn all_parts_together_are_as_many_states_as_the_largest_filter_has_room_for() {
        let campaign = Recipe { runs: 2, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        // A play may have begun in two ways.
        let play = effect("thermal-hysteresis", &campaign);
        let coefficients: Vec<f64> = play.about.parameters.iter().map(|about| about.typical).collect();
        let plays = (0..PLACES).fold(EffectSet::NONE, |set, _| set.with(&play, &coefficients));
        let initial = InitialStates::of(problem.cells(), &plays);
        assert_eq!(initial.present().len(), 2 * PLACES, "each play in each way");
        assert_eq!(states(&NoiseModel::even(5.0, 0.0), &initial).len(), kalman::MOST_STATES);
        let mut quiet = NoiseModel::even(5.0, 0.0);
        Component::ALL.into_iter().for_each(|component| quiet[component] = 0.0);
        assert!(states(&quiet, &initial).is_empty());
    }
}
