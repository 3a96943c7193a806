//! Fits the parameters of effects to what is measured, map and noise in the way: damped Gauss–Newton steps.

use super::Problem;
use super::gls_pair::GlsPair;
use crate::diagnose::cells::stacked;
use crate::diagnose::forward::{CellResiduals, EffectSet, FixedEffects};
use crate::diagnose::thresholds::LEAST_STEP_GAIN;
use crate::fit::levenberg_marquardt::{self, Limits, Quadratic, minimise};
use nalgebra::DMatrix;
use std::ops::ControlFlow;

/// A screened effect is near its best: the first step may be nearly a whole one.
const BOLD: f64 = 1e-3;
/// So many steps are tried for one that is taken.
const TRIES: usize = 8;

/// Fits the parameters of effects beside others that are fixed, in at most so many steps; and what they leave.
pub fn fit(
    problem: &Problem,
    fixed: &FixedEffects,
    set: &EffectSet,
    gls: &GlsPair,
    steps: usize,
) -> (EffectSet, CellResiduals) {
    let predicts = !set.sum_predicted().effects.is_empty();
    let mut task = Fit { problem, fixed, gls, set, predicts, left: steps, last: None };
    let start = set.coefficients.to_parameters(&set.effects);
    let cost = levenberg_marquardt::Problem::cost(&mut task, &start);
    // The limit is one on −2 log likelihood, of which the cost is half.
    let decrease = 0.5 * LEAST_STEP_GAIN / cost.max(f64::MIN_POSITIVE);
    let limits = Limits { iterations: TRIES * steps, decrease, step: 0.0, damping: BOLD };
    let point = minimise(&mut task, &start, &limits, |_, _| ControlFlow::Continue(())).point;
    let residuals = task.residuals(&point);
    (set.at(&point), residuals)
}

/// The fit as a least-squares problem of its own: half of −2 log likelihood, but for a constant.
struct Fit<'a> {
    problem: &'a Problem<'a>,
    fixed: &'a FixedEffects,
    gls: &'a GlsPair,
    set: &'a EffectSet,
    /// Whether the sum of the frequencies has a say: it has none in effects that don't predict it.
    predicts: bool,
    /// Steps that may still be taken.
    left: usize,
    /// Where the effects were evaluated last, and what they leave there.
    last: Option<(Vec<f64>, CellResiduals)>,
}

impl Fit<'_> {
    /// What the effects leave with these parameters.
    fn residuals(&mut self, point: &[f64]) -> CellResiduals {
        if let Some((last, residuals)) = &self.last
            && last == point
        {
            return residuals.clone();
        }
        let residuals = self.problem.forward.residuals_beside(self.fixed, &self.set.at(point));
        self.last = Some((point.to_vec(), residuals.clone()));
        residuals
    }

    /// Products of the residual and the derivatives by the parameters: [residual, derivatives]ᵀ[residual, derivatives].
    fn normal(&self, point: &[f64], residuals: &CellResiduals) -> DMatrix<f64> {
        let jacobian = self.problem.forward.jacobian(self.fixed, &self.set.at(point), residuals);
        let sums = residuals.sum.as_ref().zip(jacobian.sum.as_ref()).filter(|_| self.predicts);
        let sums = sums.map(|(residual, derivatives)| stacked(residual, derivatives));
        self.gls.normal(&stacked(&residuals.delta, &jacobian.delta), sums.as_ref())
    }
}

impl levenberg_marquardt::Problem for Fit<'_> {
    fn parameters(&self) -> usize {
        self.set.effects.iter().map(|effect| effect.free().count()).sum()
    }

    fn cost(&mut self, point: &[f64]) -> f64 {
        let residuals = self.residuals(point);
        let sum = residuals.sum.as_ref().filter(|_| self.predicts);
        0.5 * self.gls.normal(&residuals.delta, sum)[(0, 0)]
    }

    fn linearise(&mut self, point: &[f64], quadratic: &mut Quadratic) {
        if self.left == 0 {
            // Nothing is promised where no step may be taken any more.
            *quadratic = Quadratic { cost: self.cost(point), ..Quadratic::zeros(point.len()) };
            return;
        }
        self.left -= 1;
        let residuals = self.residuals(point);
        let normal = self.normal(point, &residuals);
        let count = point.len();
        quadratic.cost = 0.5 * normal[(0, 0)];
        quadratic.gradient.copy_from(&normal.view((1, 0), (count, 1)).column(0));
        quadratic.hessian.copy_from(&normal.view((1, 1), (count, count)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, disturbed, effect, problem, warmed_up, white};
    use crate::diagnose::problem::{fixed, widened};

    /// A bias after power-on of 200 µg that fades in 400 s.
    const TRUTH: [f64; 2] = [200e-6, 400.0];

    fn fitted(problem: &Problem, start: &EffectSet, steps: usize) -> (EffectSet, CellResiduals, GlsPair) {
        let noises = white(problem, start, 5.0);
        let gls = GlsPair::new(problem, &problem.forward.residuals(start), &fixed(problem, start), &noises).unwrap();
        let (set, residuals) = fit(problem, problem.forward.no_effects(), start, &gls, steps);
        (set, residuals, gls)
    }

    /// Standard uncertainties in the optimiser's parameters, with the map free.
    fn uncertainties(problem: &Problem, set: &EffectSet, gls: &GlsPair) -> Vec<f64> {
        let residuals = problem.forward.residuals(set);
        let jacobian = problem.forward.jacobian(problem.forward.no_effects(), set, &residuals);
        let covariance = gls.delta.score(&jacobian.delta).covariance().unwrap();
        covariance.diagonal().iter().map(|variance| variance.sqrt()).collect()
    }

    #[test]
    fn an_effect_is_found_again_within_its_uncertainty_from_far_off() {
        let (campaign, truth) = warmed_up(&TRUTH);
        let problem = problem(&campaign);
        let start = EffectSet::NONE.with(&truth.effects[0], &[40e-6, 1500.0]);
        let (found, residuals, gls) = fitted(&problem, &start, 40);
        let sigma = uncertainties(&problem, &found, &gls);
        let [found_at, true_at] = [&found, &truth].map(|set| set.coefficients.to_parameters(&set.effects));
        for ((found, truth), sigma) in found_at.iter().zip(true_at).zip(&sigma) {
            assert!((found - truth).abs() < 3.0 * sigma, "{found} {truth} ± {sigma}");
        }
        // And the uncertainty says something.
        assert!(sigma[0] < 0.1 * TRUTH[0] && sigma[1] < 0.1, "{sigma:?}");
        let left_ug = problem.cells().rms(&residuals.delta);
        assert!(left_ug < 6.0, "{left_ug}");
    }

    #[test]
    fn a_fit_from_the_truth_stays_there_and_is_no_worse() {
        let (campaign, truth) = warmed_up(&TRUTH);
        let problem = problem(&campaign);
        let (found, residuals, gls) = fitted(&problem, &truth, 12);
        let sigma = uncertainties(&problem, &truth, &gls);
        let [found_at, true_at] = [&found, &truth].map(|set| set.coefficients.to_parameters(&set.effects));
        let moved = found_at.iter().zip(&true_at).zip(&sigma).map(|((a, b), sigma)| ((a - b) / sigma).abs());
        assert!(moved.fold(0.0, f64::max) < 3.0, "{found_at:?} {true_at:?} ± {sigma:?}");
        let squares = |columns| gls.normal(columns, None)[(0, 0)];
        assert!(squares(&residuals.delta) <= squares(&problem.forward.residuals(&truth).delta));
    }

    #[test]
    fn no_steps_leave_the_start_and_a_step_from_there_gains() {
        let (campaign, truth) = warmed_up(&TRUTH);
        let problem = problem(&campaign);
        let start = EffectSet::NONE.with(&truth.effects[0], &[100e-6, 600.0]);
        let (unmoved, before, gls) = fitted(&problem, &start, 0);
        assert_eq!(unmoved.coefficients.values, start.coefficients.values);
        let (_, after, _) = fitted(&problem, &start, 1);
        let squares = |residuals: &CellResiduals| gls.normal(&residuals.delta, None)[(0, 0)];
        assert!(squares(&after) < 0.5 * squares(&before), "{} {}", squares(&after), squares(&before));
    }

    #[test]
    fn where_the_effect_predicts_the_sum_both_channels_decide() {
        let campaign = Recipe { sum: true, ..Recipe::default() }.campaign();
        let truth = EffectSet::NONE.with(&effect("thermal-lag", &campaign), &[60.0]);
        let campaign = disturbed(campaign, &truth);
        let problem = problem(&campaign);
        let start = EffectSet::NONE.with(&truth.effects[0], &[30.0]);
        let (found, residuals, _) = fitted(&problem, &start, 20);
        let tau_s = found.coefficients.values[0][0];
        assert!((tau_s / 60.0 - 1.0).abs() < 0.02, "{tau_s}");
        let rms_mhz = |residuals: &CellResiduals| problem.cells().rms(residuals.sum.as_ref().unwrap());
        let (left_mhz, before_mhz) = (rms_mhz(&residuals), rms_mhz(&problem.forward.residuals(&EffectSet::NONE)));
        assert!(left_mhz < 0.3 * before_mhz, "{left_mhz} {before_mhz}");
    }

    #[test]
    fn the_free_parameters_widen_what_may_adapt_to_what_they_can_do() {
        let (campaign, truth) = warmed_up(&TRUTH);
        let problem = problem(&campaign);
        let start = EffectSet::NONE.with(&truth.effects[0], &[150e-6, 400.0]);
        let (residuals, fixed) = (problem.forward.residuals(&start), fixed(&problem, &start));
        let noises = white(&problem, &start, 5.0);
        let wide = widened(&problem, &fixed, problem.forward.no_effects(), &start, &residuals);
        let deviance = |nuisance| GlsPair::new(&problem, &residuals, nuisance, &noises).unwrap().deviance();
        assert!(deviance(&wide) < deviance(&fixed) - 25.0, "{} {}", deviance(&wide), deviance(&fixed));
    }
}
