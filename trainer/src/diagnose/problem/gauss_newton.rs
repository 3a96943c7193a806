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
