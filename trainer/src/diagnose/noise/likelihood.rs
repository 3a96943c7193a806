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
    let all = [
        (Kind::Constant, Component::Run),
        (Kind::Mounting, Component::Mounting),
        (Kind::Position, Component::Position),
        (Kind::Node, Component::Node),
        (Kind::Fading(0), Component::Flicker),
        (Kind::Fading(1), Component::Flicker),
        (Kind::Fading(SLOWEST), Component::Wander),
        (Kind::Walk, Component::Walk),
        (Kind::Pose, Component::Pose),
        (Kind::Turning, Component::Turn),
    ];
    let began = initial.present().iter().map(|&(place, way)| (Kind::Initial(place, way), Component::Initial(place)));
    let sized = |(kind, component)| match kind {
        Kind::Walk => (kind, noise[component] * 60.0),
        _ => (kind, noise[component]),
    };
    let matters = |&(_, sigma): &(Kind, f64)| sigma > noise.sample * LEAST_STATE;
    let state = |(kind, sigma): (Kind, f64)| State { kind, variance: sigma * sigma };
    let walk = |state: State| match state.kind {
        Kind::Walk => State { variance: state.variance / 3600.0, ..state },
        _ => state,
    };
    all.into_iter().chain(began).map(sized).filter(matters).map(state).map(walk).collect()
}
