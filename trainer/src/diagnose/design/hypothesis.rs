//! How large an effect would be: as the measurements have it, or as it usually is.

use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, constrained, fit};
use crate::diagnose::selection::{Candidate, screen};
use crate::fit::effects::Chosen;
use firmware_core::effect::{About, Role};

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

/// Amplitudes of effects as sensors of this kind have them, in the order of their amplitudes.
const TYPICAL: &[(&str, &[f64])] = &[
    ("thermal-gradient", &[6e-3]),
    ("warm-up", &[140e-6]),
    ("self-heating", &[0.15]),
    ("thermal-hysteresis", &[10e-6]),
    ("stress-relaxation", &[5e-6]),
    ("aging", &[2e-6]),
    ("scale-factor-aging", &[1.0]),
    ("second-order", &[10e-6]),
    ("third-order", &[0.5e-6]),
    ("cross-axis", &[100e-6, 20e-6]),
    ("misalignment", &[100e-6, 1e-6]),
    ("supply-voltage", &[1e-3]),
    ("vibration-rectification", &[20e-6]),
    ("pressure", &[0.3e-6]),
    ("humidity", &[5e-6]),
    ("mode-crossing", &[300e-6]),
    ("g-hysteresis", &[20e-6]),
    ("reference-clock", &[3e-3]),
];

/// Coefficients as sensors of this kind have them.
pub fn typical(about: &About) -> Vec<f64> {
    let known = TYPICAL.iter().find(|(name, _)| *name == about.name);
    let mut amplitudes = known.map_or(&[][..], |(_, amplitudes)| amplitudes).iter();
    let value = |parameter: &firmware_core::effect::Parameter| match parameter.role {
        Role::Amplitude => amplitudes.next().copied().unwrap_or(parameter.start),
        Role::Shape | Role::Location | Role::Origin => parameter.start,
    };
    about.parameters.iter().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::forward::amplitudes;
    use firmware_core::effect::{ALL, about};

    #[test]
    fn every_amplitude_of_every_effect_has_a_typical_size_within_its_bounds() {
        for about in ALL.iter().filter(|about| about.is_on_device() && !about.takes_program()) {
            for index in amplitudes(about) {
                let (parameter, value) = (&about.parameters[index], typical(about)[index]);
                assert!(value > 0.0 && value < parameter.high, "{} {}", about.name, parameter.name);
            }
        }
        assert!(TYPICAL.iter().all(|(name, _)| about(name).is_some()));
    }
}
