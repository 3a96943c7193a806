//! The static map carried along with the effects that are found.
//!
//! A map that was trained with an effect inside is bent by it, the more the larger it is, and what is left of the effect
//! then is not what the effect alone would leave. Beside the effect the map bends back, as training again would bend it.

use super::Problem;
use super::noise_models::NoiseModels;
use crate::diagnose::cells::Columns;
use crate::diagnose::forward::{EffectSet, Inputs};
use crate::diagnose::regression::Gls;

/// How often what is expected of the map is learnt anew: training has no such expectation.
pub const ROUNDS: usize = 3;

/// The same problem seen from where these effects are at work: the map takes up what retraining could absorb beside them,
/// and what it could absorb further is found where they move its inputs.
pub fn carried<'a>(problem: &Problem<'a>, set: &EffectSet, noises: &NoiseModels) -> Option<Problem<'a>> {
    let inputs = problem.forward.inputs(set);
    let basis = if inputs == problem.inputs { problem.basis.clone() } else { basis_at(problem, &inputs) };
    let residual = problem.forward.residuals(set).delta;
    let gls = Gls::new(problem.cells(), &noises.initial, &noises.delta, &residual, &basis)?;
    let amplitudes = -(&problem.directions * gls.absorbed(ROUNDS));
    let forward = problem.forward.with_map(problem.forward.map.with(amplitudes.iter().copied()));
    let (directions, unseen) = (problem.directions.clone(), problem.unseen.clone());
    Some(Problem { forward, basis, directions, inputs, unseen, ..*problem })
}

/// The same problem with the noise of a sample as it is beside these effects: a bent map multiplies the thermometer's
/// noise by another slope.
pub fn rescaled<'a>(problem: Problem<'a>, set: &EffectSet) -> Problem<'a> {
    let sample_ug = problem.forward.sample_ug(set).unwrap_or(problem.sample_ug);
    let ug_per_c = problem.forward.map.ug_per_c(problem.cells());
    Problem { sample_ug, ug_per_c, ..problem }
}

fn basis_at(problem: &Problem, inputs: &Inputs) -> Columns {
    problem.forward.retraining(inputs).iter().map(|run| run * &problem.directions).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Moment, Recipe, disturbed, effect, problem, warmed_up, white};

    /// An instrument whose bias bends over temperature by 300 µg, which the line doesn't know.
    fn bent(moment: &Moment) -> f64 {
        300e-6 * (moment.temperature_c / 30.0).powi(2)
    }

    #[test]
    fn the_map_takes_up_what_training_again_would_and_no_more() {
        let campaign = Recipe { bias_g: &bent, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let none = EffectSet::NONE;
        let rms = |problem: &Problem| problem.cells().rms(&problem.forward.residuals(&none).delta);
        let here = carried(&problem, &none, &white(&problem, &none, 5.0)).unwrap();
        assert!(rms(&problem) > 100.0 && rms(&here) < 6.0, "{} {}", rms(&problem), rms(&here));
        assert!((rms(&here.as_trained()) - rms(&problem)).abs() < 1e-9);
        // Learnt once more there is hardly anything left to learn.
        let again = carried(&here, &none, &white(&problem, &none, 5.0)).unwrap();
        assert!((rms(&again) - rms(&here)).abs() < 0.1, "{} {}", rms(&again), rms(&here));
        assert_eq!(here.basis, problem.basis, "nothing moves the inputs");
    }

    #[test]
    fn beside_an_effect_the_map_is_found_where_the_effect_moves_its_inputs() {
        let straight = Recipe::default().campaign();
        let truth = EffectSet::NONE.with(&effect("thermal-lag", &straight), &[90.0]);
        let campaign = disturbed(straight, &truth);
        let problem = problem(&campaign);
        let noises = white(&problem, &truth, 5.0);
        let left = |set: &EffectSet| {
            let here = carried(&problem, set, &noises).unwrap();
            here.cells().rms(&here.forward.residuals(set).delta)
        };
        let (with, without) = (left(&truth), left(&EffectSet::NONE));
        assert!(with < 8.0 && without > 10.0 * with, "{with} {without}");
        assert_ne!(carried(&problem, &truth, &noises).unwrap().basis, problem.basis);
    }

    #[test]
    fn the_noise_of_a_sample_is_measured_beside_the_effects() {
        let (campaign, truth) = warmed_up(&[2e-4, 500.0]);
        let problem = problem(&campaign);
        let here = rescaled(problem.clone(), &truth);
        assert!(
            (4.0..6.0).contains(&here.sample_ug) && here.sample_ug <= 1.02 * problem.sample_ug,
            "{}",
            here.sample_ug
        );
        let noises = white(&problem, &truth, 7.0).of(&here);
        assert_eq!((noises.delta.sample, noises.delta.per_c), (here.sample_ug, here.ug_per_c));
    }
}
