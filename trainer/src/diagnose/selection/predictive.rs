//! Whether an effect predicts what its parameters were not fitted to.

use super::candidate::Candidate;
use super::contender::{Contender, Found, best_of_each};
use super::cross_validation::{held_out, recalling};
use super::screening::screen;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, constrained, fit, initial_states};
use crate::diagnose::regression::Measured;
use crate::diagnose::thresholds::{HALVED, LOWERED, PREDICTED, PREDICTIVE_ASKED, PREDICTIVE_STEPS, WORSE};
use rayon::prelude::*;

/// Whether runs that were left out are explained better with the effect than without, or are at least read with half
/// the error, or with clearly less of what is predictable: the residual alone, as the sum of the frequencies
/// has no held-out part of its own. Likelihood alone would not do: it weighs most where the noise is least, and there
/// no formula is exact.
pub fn is_predictive(problem: &Problem, known: &EffectSet, contender: &Contender) -> Option<bool> {
    let with = known.with(&contender.effect, &contender.values);
    let noises = contender.noises.as_ref()?.beside(&initial_states(problem, &with));
    let fitted = |set: &EffectSet| {
        let (residual, nuisance) = (problem.forward.residuals(set).delta, recalling(problem, set));
        let (cells, initial) = (problem.cells(), &*noises.initial);
        let measured = Measured { cells, initial, residual: &residual, nuisance: &nuisance };
        Some(measured.gls(&noises.delta)?.deviance)
    };
    let gain = fitted(known)? - fitted(&with)?;
    let (before, after) = (held_out(problem, known, &noises), held_out(problem, &with, &noises));
    let all = after.residual_ug / before.residual_ug;
    let predictable = after.structure_ug() / before.structure_ug();
    let predicted = before.deviance - after.deviance > PREDICTED * gain.max(0.0);
    Some(all < HALVED || predictable < LOWERED || predicted && (all < WORSE || predictable < WORSE))
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
    let before = held_out(problem, known, &small);
    let tried = screened.into_par_iter().map(|contender| {
        let (own, _) = fit(problem, &fixed, &contender.alone(), &gls, PREDICTIVE_STEPS);
        let values = own.coefficients.values.concat();
        let after = held_out(problem, &known.with(&contender.effect, &values), &small);
        let ratio = after.structure_ug() / before.structure_ug();
        // Every part that was left out counts once, however many samples it has.
        let cost = (before.parts as f64).ln() * contender.effect.free().count() as f64;
        let delta_bic = -2.0 * before.parts as f64 * ratio.ln() - cost;
        (ratio, Contender { values, delta_bic, noises: Some(small.clone()), ..contender })
    });
    let mut tried: Vec<(f64, Contender)> = tried.collect();
    tried.retain(|(ratio, contender)| ratio.is_finite() && !contender.is_at_bound(&problem.cells().range_c()));
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (best, _) = tried.first()?;
    if *best > HALVED {
        return None;
    }
    let mut order = tried.into_iter().map(|(_, contender)| contender);
    let winner = order.next()?;
    Some(Found { winner, rivals: order.collect(), at_bound: f64::NEG_INFINITY, noises: noises.clone() })
}
