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
            let found = missing(&problem, &known, &candidates, &noises)?;
            noises = found.winner.noises.unwrap_or_else(|| noises.clone());
            Some(found.winner.values)
        });
        if let Some(values) = &start {
            known = known.with(&chosen, values);
            noises = noises.beside(&initial_states(&problem, &known));
        }
        started.push(EffectChoice { start, ..choice.clone() });
    }
    Some(started)
}
