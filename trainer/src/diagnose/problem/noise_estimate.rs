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

#[cfg(test)]
mod tests {
    use super::super::noise_models::initial_states;
    use super::*;
    use crate::diagnose::example::{Gauss, Moment, Recipe, STEP_S, effect, problem, white};
    use crate::diagnose::forward::EffectSet;
    use crate::diagnose::problem::fixed;

    fn estimated(problem: &Problem) -> NoiseModels {
        let none = EffectSet::NONE;
        let residuals = problem.forward.residuals(&none);
        estimate(problem, &residuals, &fixed(problem, &none), &initial_states(problem, &none))
    }

    #[test]
    fn white_noise_of_difference_and_sum_has_no_other_part() {
        let campaign = Recipe { sum: true, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let noises = estimated(&problem);
        let sum = noises.sum.unwrap();
        // In µg and in mHz.
        for (noise, sample) in [(noises.delta, problem.sample_ug), (sum, problem.forward.sum.as_ref().unwrap().sample)]
        {
            assert!((4.0..6.0).contains(&sample), "{sample}");
            for component in [Component::Run, Component::Position, Component::Node, Component::Wander, Component::Pose]
            {
                assert!(noise[component] < 0.8 * sample, "{component:?}: {}", noise[component]);
            }
        }
    }

    #[test]
    fn an_offset_of_each_run_is_the_runs_and_refining_keeps_it() {
        let offsets: Vec<f64> = {
            let mut gauss = Gauss::new(3);
            (0..12).map(|_| 80e-6 * gauss.next()).collect()
        };
        let bias_g = |moment: &Moment| offsets[moment.run];
        let campaign = Recipe { runs: 12, rows: 120, bias_g: &bias_g, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let noises = estimated(&problem);
        let found = noises.delta[Component::Run];
        assert!((40.0..140.0).contains(&found), "{found}");
        let none = EffectSet::NONE;
        let refined = refine(&problem, &problem.forward.residuals(&none), &fixed(&problem, &none), &noises);
        assert!((refined.delta[Component::Run] / found - 1.0).abs() < 0.5);
        assert!(noises.small().delta[Component::Run] <= problem.sample_ug);
    }

    #[test]
    fn a_rig_that_leans_unseen_is_seen_as_such_and_one_that_stands_still_is_not() {
        let mut gauss = Gauss::new(9);
        // How it leans wanders within hours, run by run and row by row; it shows across the input axis only.
        let kept = (-STEP_S / 5000.0_f64).exp();
        let mut course = || -> Vec<f64> {
            let first = 300e-6 * gauss.next();
            let next = |last: &f64| Some(kept * last + 300e-6 * (1.0 - kept * kept).sqrt() * gauss.next());
            std::iter::successors(Some(first), next).take(225).collect()
        };
        let courses: Vec<Vec<f64>> = (0..8).map(|_| course()).collect();
        let bias_g = |moment: &Moment| {
            let lean_g = courses[moment.run][(moment.time_s / STEP_S).round() as usize];
            lean_g * (1.0 - moment.level_g.powi(2)).max(0.0).sqrt()
        };
        let turning = Recipe { runs: 8, bias_g: &bias_g, ..Recipe::default() }.campaign();
        let still = Recipe { runs: 8, ..Recipe::default() }.campaign();
        let [turned, unturned] = [&turning, &still].map(|campaign| estimated(&problem(campaign)).delta);
        assert!(turned[Component::Turn] > 60.0, "{turned:?}");
        assert_eq!(unturned[Component::Turn], 0.0);
    }

    #[test]
    fn noise_beside_an_effect_that_remembers_knows_what_is_left_of_its_initial_state() {
        let campaign = Recipe { runs: 2, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let lag = EffectSet::NONE.with(&effect("thermal-lag", &campaign), &[300.0]);
        let none = white(&problem, &EffectSet::NONE, 5.0);
        assert!(none.initial.present().is_empty());
        let beside = none.beside(&initial_states(&problem, &lag));
        assert_eq!(beside.initial.present(), [(0, 0)]);
        assert_eq!(beside.delta, none.delta);
        let first = beside.initial.of_run(1)[0][0][0];
        let time_s = problem.cells().runs[1].cells[0].time_s;
        assert!((first - (-time_s / 300.0).exp()).abs() < 1e-12, "{first}");
    }
}
