//! The noise of difference and sum, estimated from what effects leave.

use super::Problem;
use super::noise_models::NoiseModels;
use super::nuisance::Nuisance;
use crate::diagnose::forward::CellResiduals;
use crate::diagnose::noise::{Component, InitialStates, NoiseModel};
use crate::diagnose::regression::Measured;
use std::sync::Arc;

/// The most likely noise of what is left, where nothing is known of it.
pub fn estimate(
    problem: &Problem,
    residuals: &CellResiduals,
    nuisance: &Nuisance,
    initial: &Arc<InitialStates>,
) -> NoiseModels {
    let measured = of_delta(problem, residuals, nuisance, initial);
    let mut delta = measured.noise(NoiseModel::first_guess(problem.sample_ug, problem.ug_per_c), true);
    if problem.cells().may_turn_unseen() {
        delta = turned(problem, &measured, delta).unwrap_or(delta);
    }
    NoiseModels { delta, sum: sum_noise(problem, residuals, nuisance, None, initial), initial: initial.clone() }
}

/// The same from where it was last.
pub fn refine(problem: &Problem, residuals: &CellResiduals, nuisance: &Nuisance, start: &NoiseModels) -> NoiseModels {
    let delta = of_delta(problem, residuals, nuisance, &start.initial).noise(start.delta, false);
    let sum = sum_noise(problem, residuals, nuisance, start.sum, &start.initial);
    NoiseModels { delta, sum, initial: start.initial.clone() }
}

/// The noise of the sum alone, from `start` or where nothing is known of it.
pub fn sum_noise(
    problem: &Problem,
    residuals: &CellResiduals,
    nuisance: &Nuisance,
    start: Option<NoiseModel>,
    initial: &InitialStates,
) -> Option<NoiseModel> {
    let channel = problem.forward.sum.as_ref()?;
    let (residual, nuisance) = (residuals.sum.as_ref()?, nuisance.sum.as_ref()?);
    let first = start.unwrap_or_else(|| NoiseModel::first_guess(channel.sample, channel.per_c));
    Some(Measured { cells: problem.cells(), initial, residual, nuisance }.noise(first, start.is_none()))
}

fn of_delta<'a>(
    problem: &'a Problem,
    residuals: &'a CellResiduals,
    nuisance: &'a Nuisance,
    initial: &'a InitialStates,
) -> Measured<'a> {
    Measured { cells: problem.cells(), initial, residual: &residuals.delta, nuisance: &nuisance.delta }
}

/// The noise of a rig that was turned over unseen, if that makes what was measured more likely.
fn turned(problem: &Problem, measured: &Measured, without: NoiseModel) -> Option<NoiseModel> {
    let mut start = without;
    [Component::Turn, Component::Wander].into_iter().for_each(|component| start[component] = problem.sample_ug);
    let with = measured.noise(start, false);
    let deviance = |noise: &NoiseModel| Some(measured.gls(noise)?.deviance);
    (deviance(&with)? + problem.parameter_cost() < deviance(&without)?).then_some(with)
}
