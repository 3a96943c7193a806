//! Whether an effect predicts what its parameters were not fitted to.

use super::candidate::Candidate;
use super::contender::{Contender, Found, best_of_each};
use super::cross_validation::{HeldOut, held_out, predicted, recalling};
use super::screening::screen;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, carried, constrained, fit, initial_states};
use crate::diagnose::regression::Measured;
use crate::diagnose::thresholds::{HALVED, LOWERED, NO_WORSE, PREDICTED, PREDICTIVE_ASKED, PREDICTIVE_STEPS, WORSE};
use rayon::prelude::*;

/// Whether runs that were left out are explained better with the effect than without, or are at least read with half
/// the error, or with clearly less of what is predictable: the residual alone, as the sum of the frequencies
/// has no held-out part of its own. Likelihood alone would not do: it weighs most where the noise is least, and there
/// no formula is exact.
pub fn prediction(problem: &Problem, known: &EffectSet, contender: &Contender) -> Option<Prediction> {
    let with = known.with(&contender.effect, &contender.values);
    let noises = contender.noises.as_ref()?.beside(&initial_states(problem, &with));
    let around = carried(problem, &with, &noises)?;
    let fitted = |problem: &Problem, set: &EffectSet| {
        let (residual, nuisance) = (problem.forward.residuals(set).delta, recalling(problem, set));
        let (cells, initial) = (problem.cells(), &*noises.initial);
        let measured = Measured { cells, initial, residual: &residual, nuisance: &nuisance };
        Some(measured.gls(&noises.delta)?.deviance)
    };
    // The map takes up what it can on both sides.
    let without = carried(problem, known, &noises)?;
    let gain = fitted(&without, known)? - fitted(&around, &with)?;
    let (before, after) = (held_out(&without, known, &noises), held_out(&around, &with, &noises));
    let unseen_worse =
        problem.unseen.is_some() && is_worse(&predicted(problem, known, &noises), &predicted(&around, &with, &noises));
    let all = after.residual_ug / before.residual_ug;
    let predictable = after.structure_ug() / before.structure_ug();
    let predicted = before.deviance - after.deviance > PREDICTED * gain.max(0.0);
    let better = all < HALVED || predictable < LOWERED || predicted && (all < WORSE || predictable < WORSE);
    Some(Prediction { holds: better && !unseen_worse, ratio: predictable })
}

/// What an effect makes of what was left out.
#[derive(Clone, Copy, Debug)]
pub struct Prediction {
    /// Whether it is worth having there.
    pub holds: bool,
    /// Residual with it over that without it, what is each run's own aside.
    pub ratio: f64,
}

/// Whether what was left out is read worse, with what is each run's own and without.
pub fn reads_worse(before: &HeldOut, after: &HeldOut) -> bool {
    after.residual_ug > NO_WORSE * before.residual_ug && after.structure_ug() > NO_WORSE * before.structure_ug()
}

/// Whether it is read worse and is less likely, too: an effect beside which another is missing may read worse alone.
pub fn is_worse(before: &HeldOut, after: &HeldOut) -> bool {
    reads_worse(before, after) && after.deviance > before.deviance
}

/// The effect with which what was left out is predicted far better than without, wherever a wander that large hides
/// what likelihood could say. The noise is taken to be small, so that effects compete with effects and not with it.
pub fn most_predictive(
    problem: &Problem,
    known: &EffectSet,
    candidates: &[Candidate],
    noises: &NoiseModels,
) -> Option<Found> {
    let residuals = problem.forward.residuals(known);
    let (nuisance, fixed) = (constrained(problem, known, noises), problem.forward.fixed(known));
    let small = noises.small();
    let gls = GlsPair::new(problem, &residuals, &nuisance, &small)?;
    let mut screened = screen(problem, &gls, known, candidates);
    screened.retain(|contender| contender.effect.expression.is_none());
    screened.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    let mut screened = best_of_each(screened);
    screened.truncate(PREDICTIVE_ASKED);
    let before = held_out(&carried(problem, known, &small)?, known, &small);
    let tried = screened.into_par_iter().map(|contender| {
        let (own, _) = fit(problem, &fixed, &contender.alone(), &gls, PREDICTIVE_STEPS);
        let values = own.coefficients.values.concat();
        let with = known.with(&contender.effect, &values);
        let after = held_out(&carried(problem, &with, &small)?, &with, &small);
        let ratio = after.structure_ug() / before.structure_ug();
        // Every part that was left out counts once, however many samples it has.
        let cost = (before.parts as f64).ln() * contender.effect.free().count() as f64;
        let delta_bic = -2.0 * before.parts as f64 * ratio.ln() - cost;
        Some((ratio, Contender { values, delta_bic, noises: Some(small.clone()), ..contender }))
    });
    let mut tried: Vec<(f64, Contender)> = tried.flatten().collect();
    tried.retain(|(ratio, contender)| ratio.is_finite() && !contender.is_at_bound(&problem.cells().range_c()));
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (best, _) = tried.first()?;
    if *best > HALVED {
        return None;
    }
    let mut order = tried.into_iter().map(|(_, contender)| contender);
    let winner = order.next()?;
    Some(Found { winner, rivals: order.collect(), noises: noises.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Campaign;
    use crate::diagnose::example::{Recipe, effect, problem, warmed_up, white};

    fn contender(problem: &Problem, set: &EffectSet, values: &[f64]) -> Contender {
        let noises = Some(white(problem, &EffectSet::NONE, 5.0));
        Contender {
            effect: set.effects[0].clone(),
            values: values.to_vec(),
            delta_bic: 100.0,
            noises,
            determined: true,
        }
    }

    #[test]
    fn what_is_there_predicts_other_runs_and_what_is_not_there_does_not() {
        let (campaign, truth) = warmed_up(&[2e-4, 500.0]);
        let still = Recipe::default().campaign();
        let none = EffectSet::NONE;
        let (with, without) = (problem(&campaign), problem(&still));
        let holds = |problem, contender: &Contender| prediction(problem, &none, contender).map(|one| one.holds);
        assert_eq!(holds(&with, &contender(&with, &truth, &[2e-4, 500.0])), Some(true));
        assert_eq!(holds(&without, &contender(&without, &truth, &[2e-4, 500.0])), Some(false));
        let ratio = prediction(&with, &none, &contender(&with, &truth, &[2e-4, 500.0])).unwrap().ratio;
        assert!((0.0..0.5).contains(&ratio), "{ratio}");
        let unjudged = Contender { noises: None, ..contender(&with, &truth, &[2e-4, 500.0]) };
        assert_eq!(holds(&with, &unjudged), None);
    }

    #[test]
    fn worse_is_what_reads_left_out_runs_worse_whatever_is_their_own_and_is_less_likely() {
        let held = |residual_ug, predictable_ug, deviance| HeldOut {
            residual_ug,
            predictable_ug,
            deviance,
            parts: 1,
            whole_runs: true,
        };
        let before = held(50.0, 20.0, 1000.0);
        assert!(is_worse(&before, &held(51.0, 20.5, 1001.0)));
        // The offset of one run by itself, or a hundredth, is chance.
        for after in
            [held(60.0, 20.0, 1001.0), held(50.0, 30.0, 1001.0), held(50.4, 20.1, 1001.0), held(60.0, 30.0, 900.0)]
        {
            assert!(!is_worse(&before, &after));
            assert_eq!(reads_worse(&before, &after), after.deviance < before.deviance);
        }
    }

    #[test]
    fn the_effect_that_halves_what_is_left_out_is_named_and_none_on_noise() {
        let (campaign, truth) = warmed_up(&[2e-4, 500.0]);
        let still = Recipe::default().campaign();
        let named = |campaign: &Campaign| {
            let problem = problem(campaign);
            let shown = ["warm-up", "thermal-gradient", "thermal-hysteresis"].map(|name| effect(name, campaign));
            let candidates = Candidate::all(&problem, &shown);
            most_predictive(&problem, &EffectSet::NONE, &candidates, &white(&problem, &EffectSet::NONE, 5.0))
        };
        let found = named(&campaign).unwrap();
        assert_eq!(found.winner.effect.about.name, "warm-up");
        for (value, truth) in found.winner.values.iter().zip(&truth.coefficients.values[0]) {
            assert!((value / truth - 1.0).abs() < 0.1, "{value} {truth}");
        }
        assert!(named(&still).is_none());
    }
}
