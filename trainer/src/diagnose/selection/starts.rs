//! Where a joint fit of effects should begin: as a diagnosis of the static model would fit them, one beside the other.

use super::candidate::Candidate;
use super::forward_selection::missing;
use crate::campaign::Campaign;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{estimate, fixed, initial_states, problem};
use crate::effect_choice::{EffectChoice, choose};
use crate::model::Model;
use crate::yardstick::Yardstick;

/// The choices with their starts; effects that say nothing keep the start that they have. In the units of `yardstick`,
/// as `campaign` is.
pub fn starts(
    model: &Model,
    campaign: &Campaign,
    yardstick: &Yardstick,
    choices: &[EffectChoice],
) -> Option<Vec<EffectChoice>> {
    let problem = problem(model, campaign, yardstick).ok()?;
    let runs: Vec<_> = campaign.runs.iter().collect();
    let mut known = EffectSet::NONE;
    let (residuals, nuisance) = (problem.forward.residuals(&known), fixed(&problem, &known));
    let mut noises = estimate(&problem, &residuals, &nuisance, &initial_states(&problem, &known));
    let mut started = Vec::new();
    for choice in choices {
        let chosen = choose(choice, campaign, &runs).ok()?;
        let start = choice.start.clone().or_else(|| {
            let candidates = Candidate::all(&problem, std::slice::from_ref(&chosen));
            let best = missing(&problem, &known, &[], &candidates, &noises)?.best?;
            noises = best.noises.unwrap_or_else(|| noises.clone());
            Some(best.values)
        });
        if let Some(values) = &start {
            known = known.with(&chosen, values);
            noises = noises.beside(&initial_states(&problem, &known));
        }
        started.push(EffectChoice { start, ..choice.clone() });
    }
    Some(started)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{self, Moment, Recipe, disturbed, effect};

    fn found(campaign: &Campaign, choices: &[EffectChoice]) -> Vec<EffectChoice> {
        let model = example::model();
        let yardstick = Yardstick::of_model(&model, campaign).unwrap();
        starts(&model, campaign, &yardstick, choices).unwrap()
    }

    #[test]
    fn a_start_is_found_near_the_truth_and_one_that_was_given_is_kept() {
        let still = Recipe::default().campaign();
        let truth = EffectSet::NONE
            .with(&effect("warm-up", &still), &[2e-4, 500.0])
            .with(&effect("thermal-gradient", &still), &[5e-3, 60.0]);
        let campaign = disturbed(still, &truth);
        let given = EffectChoice { start: Some(vec![5e-3, 60.0]), ..EffectChoice::named("thermal-gradient") };
        let found = found(&campaign, &[given.clone(), EffectChoice::named("warm-up")]);
        assert_eq!(found[0], given);
        let start = found[1].start.as_ref().unwrap();
        assert!((start[0] / 2e-4 - 1.0).abs() < 0.2 && (start[1] / 500.0 - 1.0).abs() < 0.2, "{start:?}");
    }

    #[test]
    fn what_a_known_lag_brought_along_is_not_taken_for_the_next_effect() {
        // Before each run a soak elsewhere, now warmer and now colder: what is left of it fades as the lag forgets.
        let brought_c = [0.4, -0.25, 0.35, -0.5, 0.3, 0.45];
        let bias_g = |moment: &Moment| {
            let left_c = brought_c[moment.run] * (-moment.time_s / 400.0).exp();
            -left_c * example::G_PER_C + 60e-6 * (-moment.time_s / 1500.0).exp()
        };
        let still = Recipe { runs: 6, bias_g: &bias_g, ..Recipe::default() }.campaign();
        let lag = EffectSet::NONE.with(&effect("thermal-lag", &still), &[400.0]);
        let campaign = disturbed(still, &lag);
        let given = EffectChoice { start: Some(vec![400.0]), ..EffectChoice::named("thermal-lag") };
        let found = found(&campaign, &[given, EffectChoice::named("warm-up")]);
        let start = found[1].start.as_ref().unwrap();
        assert!((start[0] / 60e-6 - 1.0).abs() < 0.3 && start[1] > 1000.0, "{start:?}");
    }
}
