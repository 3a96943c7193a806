//! The findings as they are told: residuals before and after each, parameters with their uncertainties, and rivals.

use super::found::Findings;
use crate::diagnose::answer::{Estimate, Finding};
use crate::diagnose::design::separate;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, fixed};
use crate::diagnose::regression::Score;
use crate::diagnose::selection::{Found, held_out};
use crate::diagnose::thresholds::{CONFOUNDED, CONFOUNDED_SHARE};
use firmware_core::effect::Role;
use nalgebra::DVector;
use std::collections::BTreeMap;

/// What was found, from the residual before it on, µg.
pub fn findings(problem: &Problem, start: &EffectSet, found: &Findings, mut residual_ug: f64) -> Vec<Finding> {
    let sigmas = sigmas(problem, &found.known, &found.noises);
    let mut known = start.clone();
    let mut findings = Vec::new();
    for (index, step) in found.steps.iter().enumerate() {
        let at = start.effects.len() + index;
        known = known.with(&found.known.effects[at], &found.known.coefficients.values[at]);
        let after_ug = held_out(problem, &known, &found.noises).residual_ug;
        let name = step.winner.effect.about.name;
        let confounded_with = confounded(step);
        findings.push(Finding {
            effect: name.to_owned(),
            residual_before_ug: residual_ug,
            residual_after_ug: after_ug,
            delta_bic: step.winner.delta_bic,
            parameters: parameters(&found.known, &sigmas, at),
            separate_by: confounded_with.first().map(|other| separate(name, other)),
            confounded_with,
        });
        residual_ug = after_ug;
    }
    findings
}

fn confounded(step: &Found) -> Vec<String> {
    let enough = step.winner.delta_bic - CONFOUNDED.max(CONFOUNDED_SHARE * step.winner.delta_bic);
    let rivals = step.rivals.iter().filter(|rival| rival.delta_bic > enough && rival.delta_bic > 0.0);
    rivals.map(|rival| rival.effect.about.name.to_owned()).collect()
}

fn parameters(known: &EffectSet, sigmas: &[Vec<f64>], at: usize) -> BTreeMap<String, Estimate> {
    let (effect, values) = (&known.effects[at], &known.coefficients.values[at]);
    let each = effect.about.parameters.iter().zip(values).zip(&sigmas[at]);
    each.filter(|((about, _), _)| about.role != Role::Origin)
        .map(|((about, value), sigma)| (about.name.to_owned(), Estimate { value: *value, sigma: *sigma }))
        .collect()
}

/// Standard uncertainties of all coefficients, effect by effect.
fn sigmas(problem: &Problem, known: &EffectSet, noises: &NoiseModels) -> Vec<Vec<f64>> {
    let parameters = known.coefficients.to_parameters(&known.effects);
    let forward = &problem.forward;
    let residuals = forward.residuals(known);
    let gls = GlsPair::new(problem, &residuals, &fixed(problem, known), noises);
    let covariance = gls.and_then(|gls| {
        let jacobian = forward.jacobian(forward.no_effects(), known, &residuals);
        let normal = gls.normal(&jacobian.delta, jacobian.sum.as_ref());
        // Where the data say nothing of a parameter, its bounds do.
        Score { right: DVector::zeros(normal.nrows()), normal }.covariance()
    });
    let sigma = |i: usize| covariance.as_ref().map_or(0.0, |covariance| covariance[(i, i)].max(0.0).sqrt());
    // One sigma up or down in the optimiser's parameters, seen in the coefficients' own units: at a bound, one is nothing.
    let moved = |sign: f64| {
        known.at(&parameters.iter().enumerate().map(|(i, value)| value + sign * sigma(i)).collect::<Vec<_>>())
    };
    let away = |moved: &[f64], here: &[f64]| moved.iter().zip(here).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>();
    let [up, down] = [moved(1.0), moved(-1.0)].map(|moved| moved.coefficients.values);
    let larger = |((up, down), here): ((&Vec<f64>, &Vec<f64>), &Vec<f64>)| {
        away(up, here).into_iter().zip(away(down, here)).map(|(up, down)| up.max(down)).collect()
    };
    up.iter().zip(&down).zip(&known.coefficients.values).map(larger).collect()
}
