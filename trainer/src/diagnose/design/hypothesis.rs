//! How large an effect would be: as the measurements have it, or as it usually is.

use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, constrained, fit};
use crate::diagnose::selection::{Candidate, screen};
use crate::diagnose::thresholds::{HYPOTHESIS_STEPS, LEAST_SIGN};
use crate::fit::effects::Chosen;
use firmware_core::effect::About;

/// The coefficients of `effect` beside `known` that fit best; none if there is no sign of it.
pub fn fitted(problem: &Problem, known: &EffectSet, noises: &NoiseModels, effect: &Chosen) -> Option<Vec<f64>> {
    let candidates = Candidate::all(problem, std::slice::from_ref(effect));
    let (residuals, nuisance) = (problem.forward.residuals(known), constrained(problem, known, noises));
    let gls = GlsPair::new(problem, &residuals, &nuisance, noises)?;
    let screened = screen(problem, &gls, known, &candidates).into_iter();
    let best =
        screened.max_by(|a, b| a.delta_bic.total_cmp(&b.delta_bic)).filter(|best| best.delta_bic > LEAST_SIGN)?;
    let (fitted, _) = fit(problem, &problem.forward.fixed(known), &best.alone(), &gls, HYPOTHESIS_STEPS);
    Some(fitted.coefficients.values.concat())
}

/// Coefficients as sensors of this kind have them.
pub fn typical(about: &About) -> Vec<f64> {
    about.parameters.iter().map(|parameter| parameter.typical).collect()
}
