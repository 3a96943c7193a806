//! Fits the parameters of effects to what is measured, map and noise in the way: Gauss–Newton steps, damped
//! (Levenberg 1944; Marquardt 1963).

use super::Problem;
use super::gls_pair::GlsPair;
use crate::diagnose::cells::stacked;
use crate::diagnose::forward::{CellResiduals, EffectSet, FixedEffects};
use crate::diagnose::thresholds::LEAST_STEP_GAIN;
use nalgebra::{DMatrix, DVector};

const MOST_DAMPING: f64 = 1e6;

/// What stays the same during a fit.
struct Fit<'a> {
    problem: &'a Problem<'a>,
    fixed: &'a FixedEffects,
    gls: &'a GlsPair,
    /// Whether the sum of the frequencies has a say: it has none in effects that don't predict it.
    predicts: bool,
}

/// Effects, what they leave, and how much that is.
struct Place {
    set: EffectSet,
    residuals: CellResiduals,
    squares: f64,
}

/// Fits the parameters of effects beside others that are fixed, in at most so many steps; and what they leave.
pub fn fit(
    problem: &Problem,
    fixed: &FixedEffects,
    set: &EffectSet,
    gls: &GlsPair,
    steps: usize,
) -> (EffectSet, CellResiduals) {
    let fit = Fit { problem, fixed, gls, predicts: !set.sum_predicted().effects.is_empty() };
    let (mut best, mut damping) = (fit.place(set.clone()), 1e-3);
    for _ in 0..steps {
        let before = best.squares;
        best = fit.improved(best, &mut damping);
        if before - best.squares < LEAST_STEP_GAIN {
            break;
        }
    }
    (best.set, best.residuals)
}

impl Fit<'_> {
    fn place(&self, set: EffectSet) -> Place {
        let residuals = self.problem.forward.residuals_beside(self.fixed, &set);
        let sum = residuals.sum.as_ref().filter(|_| self.predicts);
        let squares = self.gls.normal(&residuals.delta, sum)[(0, 0)];
        Place { set, residuals, squares }
    }

    /// One step on, or where it was if no step is any better.
    fn improved(&self, from: Place, damping: &mut f64) -> Place {
        let normal = self.normal(&from);
        let parameters = from.set.coefficients.to_parameters(&from.set.effects);
        while *damping < MOST_DAMPING {
            let step = damped_step(&normal, *damping).unwrap_or_else(|| DVector::zeros(parameters.len()));
            let stepped: Vec<f64> = parameters.iter().zip(step.iter()).map(|(p, s)| p + s).collect();
            let next = self.place(from.set.at(&stepped));
            if next.squares < from.squares {
                *damping *= 0.1;
                return next;
            }
            *damping *= 10.0;
        }
        from
    }

    /// Products of the residual and the derivatives by the parameters: [residual, derivatives]ᵀ[residual, derivatives].
    fn normal(&self, place: &Place) -> DMatrix<f64> {
        let jacobian = self.problem.forward.jacobian(self.fixed, &place.set, &place.residuals);
        let sums = place.residuals.sum.as_ref().zip(jacobian.sum.as_ref()).filter(|_| self.predicts);
        let sums = sums.map(|(residual, derivatives)| stacked(residual, derivatives));
        self.gls.normal(&stacked(&place.residuals.delta, &jacobian.delta), sums.as_ref())
    }
}

/// Gauss–Newton step from the products of [residual, derivatives].
fn damped_step(normal: &DMatrix<f64>, damping: f64) -> Option<DVector<f64>> {
    let count = normal.nrows() - 1;
    let mut inner = normal.view((1, 1), (count, count)).into_owned();
    for i in 0..count {
        inner[(i, i)] = inner[(i, i)] * (1.0 + damping) + f64::MIN_POSITIVE;
    }
    let right: DVector<f64> = -normal.view((1, 0), (count, 1)).column(0);
    Some(inner.cholesky()?.solve(&right))
}
