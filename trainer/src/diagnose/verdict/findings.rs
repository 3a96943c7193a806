//! The findings as they are told: residuals before and after each, parameters with their uncertainties, and rivals.

use super::found::Findings;
use crate::diagnose::answer::{Estimate, Finding};
use crate::diagnose::design::separate;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{Problem, carried};
use crate::diagnose::selection::{Found, HeldOut, predicted, standard_uncertainties};
use crate::diagnose::thresholds::{CONFOUNDED, CONFOUNDED_SHARE};
use firmware_core::effect::Role;
use std::collections::BTreeMap;

/// What was found, from the residual of the model as it is on, µg: it falls as much as that which is predicted without
/// training, at the start and with all findings.
pub fn findings(
    problem: &Problem,
    start: &EffectSet,
    found: &Findings,
    mut residual_ug: f64,
    [at_start, at_end]: [&HeldOut; 2],
) -> Vec<Finding> {
    let unit = residual_ug / at_start.residual_ug;
    let sigmas = standard_uncertainties(&found.problem, &found.known, &found.noises);
    let mut known = start.clone();
    let mut findings = Vec::new();
    for (index, step) in found.steps.iter().enumerate() {
        let at = start.effects.len() + index;
        known = known.with(&found.known.effects[at], &found.known.coefficients.values[at]);
        let is_last = index + 1 == found.steps.len();
        let around = if is_last { None } else { carried(problem, &known, &found.noises) };
        let after = around.map(|around| predicted(&around, &known, &found.noises));
        let after_ug = after.as_ref().unwrap_or(at_end).residual_ug * unit;
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
