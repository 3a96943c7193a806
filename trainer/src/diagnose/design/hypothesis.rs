//! How large an effect would be: as the measurements have it, or as it usually is.

use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, constrained, fit};
use crate::diagnose::selection::{Candidate, screen};
use crate::fit::effects::Chosen;
use firmware_core::effect::About;

/// A smaller ΔBIC than this, and the measurements don't say how large an effect is.
const ENOUGH: f64 = 15.0;
/// Steps of the fit.
const STEPS: usize = 12;

/// The coefficients of `effect` beside `known` that fit best; none if there is no sign of it.
pub fn fitted(problem: &Problem, known: &EffectSet, noises: &NoiseModels, effect: &Chosen) -> Option<Vec<f64>> {
    let candidates = Candidate::all(problem, std::slice::from_ref(effect));
    let (residuals, nuisance) = (problem.forward.residuals(known), constrained(problem, known, noises));
    let gls = GlsPair::new(problem, &residuals, &nuisance, noises)?;
    let screened = screen(problem, &gls, known, &candidates).into_iter();
    let best = screened.max_by(|a, b| a.delta_bic.total_cmp(&b.delta_bic)).filter(|best| best.delta_bic > ENOUGH)?;
    let (fitted, _) = fit(problem, &problem.forward.fixed(known), &best.alone(), &gls, STEPS);
    Some(fitted.coefficients.values.concat())
}

/// Coefficients as sensors of this kind have them.
pub fn typical(about: &About) -> Vec<f64> {
    about.parameters.iter().map(|parameter| parameter.typical).collect()
}
