//! How well the campaign determines the parameters of effects, and whether well enough for a finding.

use crate::diagnose::forward::{EffectSet, amplitudes};
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, fixed};
use crate::diagnose::regression::Score;
use crate::diagnose::thresholds::{REMEMBERED, SIGNIFICANT_SIGMA};
use crate::fit::at_bound::AT_BOUND;
use firmware_core::effect::{Parameter, Role};
use nalgebra::DVector;

/// Standard uncertainties of all coefficients, effect by effect.
pub fn standard_uncertainties(problem: &Problem, known: &EffectSet, noises: &NoiseModels) -> Vec<Vec<f64>> {
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

/// Whether the last effect of a set is determined: one of its amplitudes lies so many standard uncertainties from nothing (of
/// one that comes in one size, its time constant), and something of what it remembers is left at the next sample.
pub fn is_determined(problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> bool {
    let sigmas = standard_uncertainties(problem, set, noises);
    let (Some(effect), Some(values), Some(sigmas)) =
        (set.effects.last(), set.coefficients.values.last(), sigmas.last())
    else {
        return false;
    };
    let parameters = || effect.about.parameters.iter().zip(values).zip(sigmas);
    let has_amplitude = !amplitudes(effect.about).is_empty();
    let sized = if has_amplitude { Role::Amplitude } else { Role::Shape };
    let significant = parameters().filter(|((about, _), _)| about.role == sized).any(|((about, value), sigma)| {
        // At its bound an amplitude is as large as it may be, whatever the slope of the optimiser's parameter there.
        let is_largest = *value * AT_BOUND > about.high || *value * AT_BOUND < about.low;
        is_largest && has_amplitude || value.abs() > SIGNIFICANT_SIGMA * sigma
    });
    let interval_s = problem.cells().interval_s();
    let is_fleeting = |((about, value), _): ((&Parameter, &f64), &f64)| {
        let is_time = about.role == Role::Shape && about.unit == "s";
        // Where nothing at all is a sound limit, it is as good as any.
        is_time && f64::exp(-interval_s / value) < REMEMBERED && !about.sound_limit.is_low()
    };
    significant && !parameters().any(is_fleeting)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, STEP_S, effect, problem, warmed_up, white};

    #[test]
    fn what_is_there_is_determined_and_what_is_not_there_is_not() {
        let (campaign, truth) = warmed_up(&[2e-4, 500.0]);
        let problem = problem(&campaign);
        let noises = white(&problem, &truth, 5.0);
        assert!(is_determined(&problem, &truth, &noises));
        let faint = EffectSet::NONE.with(&truth.effects[0], &[1e-6, 500.0]);
        let sigma = standard_uncertainties(&problem, &faint, &noises)[0][0];
        assert!(!is_determined(&problem, &faint, &noises) && sigma > 1e-6 / SIGNIFICANT_SIGMA, "{sigma}");
        assert!(!is_determined(&problem, &EffectSet::NONE, &noises));
    }

    #[test]
    fn something_of_what_is_remembered_must_be_left_at_the_next_sample() {
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let noises = white(&problem, &EffectSet::NONE, 5.0);
        assert!((problem.cells().interval_s() - STEP_S).abs() < 1e-9);
        for (tau_s, determined) in [(0.2 * STEP_S, false), (0.5 * STEP_S, true), (3.0 * STEP_S, true)] {
            let set = EffectSet::NONE.with(&effect("thermal-lag", &campaign), &[tau_s]);
            assert_eq!(is_determined(&problem, &set, &noises), determined, "{tau_s}");
        }
    }

    #[test]
    fn an_amplitude_at_its_bound_is_large() {
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let about = effect("thermal-gradient", &campaign);
        let set = EffectSet::NONE.with(&about, &[about.about.parameters[0].high, 30.0]);
        assert!(is_determined(&problem, &set, &white(&problem, &set, 5.0)));
    }
}
