//! Levenberg–Marquardt: minimises a sum of squares of which it knows only the local quadratic model.
//!
//! A problem hands over cost, gradient and Gauss–Newton matrix of its own making, so dense, separable
//! and regularised problems share this one loop. The matrix is only the metric of the step: where the
//! iteration ends is decided by the gradient, which the problem computes from the residuals, so the
//! squared condition number of normal equations costs iterations and not digits (the NIST certified
//! problems in the tests hold it to that).
//!
//! Damping after Nielsen, IMM-REP-1999-05; scaling after Moré 1978, but with a memory that fades.

use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;

/// A least-squares problem, seen from one point.
pub trait Problem {
    /// Number of parameters.
    fn parameters(&self) -> usize;

    /// Half the sum of squares at `point`; infinite where the problem is not defined.
    fn cost(&mut self, point: &[f64]) -> f64;

    /// Cost, gradient and Gauss–Newton matrix at `point`.
    fn linearise(&mut self, point: &[f64], quadratic: &mut Quadratic);
}

/// The local model ½‖r‖² + gᵀd + ½dᵀHd.
#[derive(Clone, Debug)]
pub struct Quadratic {
    /// Half the sum of squares.
    pub cost: f64,
    /// Jᵀr.
    pub gradient: DVector<f64>,
    /// JᵀJ or an approximation to it; symmetric, at least positive semidefinite.
    pub hessian: DMatrix<f64>,
}

impl Quadratic {
    /// A model of `n` parameters, all zero.
    #[must_use]
    pub fn zeros(n: usize) -> Self {
        Self { cost: 0.0, gradient: DVector::zeros(n), hessian: DMatrix::zeros(n, n) }
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most iterations, rejected steps included.
    pub iterations: usize,
    /// Stop when a step promises to lower the cost by less than this fraction of it.
    pub decrease: f64,
    /// Stop when no parameter moves by more than this fraction of its size.
    pub step: f64,
    /// Damping of the first step, relative to the matrix's diagonal: [`CAUTIOUS`] far from a minimum.
    pub damping: f64,
}

/// Why the iteration ended. None of them is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// No step promises a worthwhile decrease.
    Converged,
    /// The step became smaller than the limit.
    SmallStep,
    /// The limit on iterations was reached.
    IterationLimit,
    /// Even the steepest short step does not lower the cost: rounding is all that is left.
    Stalled,
    /// The observer asked to stop.
    Cancelled,
}

/// Where the iteration ended.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The parameters.
    pub point: Vec<f64>,
    /// Half the sum of squares there.
    pub cost: f64,
    /// Iterations made.
    pub iterations: usize,
    /// Why it ended.
    pub termination: Termination,
}

/// First damping far from a minimum: there the model is good for a short step only; a long one may end where no gradient
/// leads back from. Caution costs ten steps.
pub const CAUTIOUS: f64 = 1e3;
const LEAST_DAMPING: f64 = 1e-15;
const MOST_DAMPING: f64 = 1e16;
/// Share of a remembered scale that is left after an accepted step.
const FADING: f64 = 0.9;
/// A difference of two costs below this fraction of them is rounding.
const ROUNDING: f64 = 1e-10;

/// Minimises `problem` from `start`. After each accepted step `observe` sees iteration and cost.
pub fn minimise(
    problem: &mut impl Problem,
    start: &[f64],
    limits: &Limits,
    mut observe: impl FnMut(usize, f64) -> ControlFlow<()>,
) -> Minimum {
    let mut search = Search::new(problem, start, limits.damping);
    for iteration in 1..=limits.iterations {
        let step = search.step(problem, limits);
        if let Step::End(termination) = step {
            return search.finish(iteration, termination);
        }
        if matches!(step, Step::Accepted) && observe(iteration, search.quadratic.cost).is_break() {
            return search.finish(iteration, Termination::Cancelled);
        }
    }
    search.finish(limits.iterations, Termination::IterationLimit)
}

enum Step {
    Accepted,
    Rejected,
    End(Termination),
}

struct Search {
    point: Vec<f64>,
    trial: Vec<f64>,
    quadratic: Quadratic,
    scale: DVector<f64>,
    damping: f64,
    growth: f64,
    /// The decrease that the last step promised.
    promised: f64,
}

impl Search {
    fn new(problem: &mut impl Problem, start: &[f64], damping: f64) -> Self {
        let mut quadratic = Quadratic::zeros(problem.parameters());
        problem.linearise(start, &mut quadratic);
        let mut search = Self {
            point: start.to_vec(),
            trial: start.to_vec(),
            scale: DVector::zeros(problem.parameters()),
            quadratic,
            damping,
            growth: 2.0,
            promised: f64::INFINITY,
        };
        search.rescale();
        search
    }

    /// Moré's scaling: the largest diagonal of late, so that a parameter whose influence fades is not
    /// suddenly allowed to run away. Of late, because one that was much stronger long ago must not stay
    /// frozen for ever.
    fn rescale(&mut self) {
        for (scale, diagonal) in self.scale.iter_mut().zip(self.quadratic.hessian.diagonal().iter()) {
            *scale = (FADING * *scale).max(*diagonal);
        }
    }

    fn step(&mut self, problem: &mut impl Problem, limits: &Limits) -> Step {
        let Some(direction) = self.direction() else {
            return self.reject();
        };
        let promised = self.predicted_decrease(&direction);
        // A step that the damping holds short promises little however far the minimum is.
        if promised * (1.0 + self.damping) <= limits.decrease * self.quadratic.cost || promised <= 0.0 {
            return Step::End(Termination::Converged);
        }
        if self.is_small(&direction, limits.step) {
            return Step::End(Termination::SmallStep);
        }
        let rounding = ROUNDING * self.quadratic.cost;
        if promised <= rounding && promised >= self.promised {
            return Step::End(Termination::Converged);
        }
        self.promised = promised;
        for ((trial, point), d) in self.trial.iter_mut().zip(&self.point).zip(direction.iter()) {
            *trial = point + d;
        }
        let decrease = self.quadratic.cost - problem.cost(&self.trial);
        // The gradient has more digits than the difference of two costs: where that is rounding, the
        // promise counts, as long as the next one is smaller.
        let ratio = if promised <= rounding && decrease >= -rounding { 1.0 } else { decrease / promised };
        if ratio > 1e-4 {
            self.accept(problem, ratio);
            Step::Accepted
        } else {
            self.reject()
        }
    }

    /// (H + λ·diag)·d = −g; `None` where rounding has made the matrix indefinite.
    fn direction(&self) -> Option<DVector<f64>> {
        let mut damped = self.quadratic.hessian.clone();
        for (i, scale) in self.scale.iter().enumerate() {
            // A parameter without any influence still needs a pivot; whichever, for its gradient is zero.
            damped[(i, i)] += self.damping * if *scale > 0.0 { *scale } else { 1.0 };
        }
        let solution = damped.cholesky()?.solve(&-&self.quadratic.gradient);
        solution.iter().all(|value| value.is_finite()).then_some(solution)
    }

    fn predicted_decrease(&self, direction: &DVector<f64>) -> f64 {
        let curvature = (&self.quadratic.hessian * direction).dot(direction);
        -self.quadratic.gradient.dot(direction) - 0.5 * curvature
    }

    fn is_small(&self, direction: &DVector<f64>, fraction: f64) -> bool {
        self.point.iter().zip(direction.iter()).all(|(point, d)| d.abs() <= fraction * (point.abs() + fraction))
    }

    fn accept(&mut self, problem: &mut impl Problem, ratio: f64) {
        std::mem::swap(&mut self.point, &mut self.trial);
        problem.linearise(&self.point, &mut self.quadratic);
        self.rescale();
        let shrink = 1.0 - (2.0 * ratio - 1.0).powi(3);
        self.damping = (self.damping * shrink.max(1.0 / 3.0)).max(LEAST_DAMPING);
        self.growth = 2.0;
    }

    fn reject(&mut self) -> Step {
        self.damping *= self.growth;
        self.growth *= 2.0;
        if self.damping > MOST_DAMPING { Step::End(Termination::Stalled) } else { Step::Rejected }
    }

    fn finish(self, iterations: usize, termination: Termination) -> Minimum {
        Minimum { point: self.point, cost: self.quadratic.cost, iterations, termination }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as a sum of two squares, its second parameter in any unit.
    struct Rosenbrock {
        unit: f64,
    }

    impl Problem for Rosenbrock {
        fn parameters(&self) -> usize {
            2
        }

        fn cost(&mut self, p: &[f64]) -> f64 {
            let (r1, r2) = (10.0 * (p[1] * self.unit - p[0] * p[0]), 1.0 - p[0]);
            0.5 * (r1 * r1 + r2 * r2)
        }

        fn linearise(&mut self, p: &[f64], quadratic: &mut Quadratic) {
            let r = DVector::from_vec(vec![10.0 * (p[1] * self.unit - p[0] * p[0]), 1.0 - p[0]]);
            let j = DMatrix::from_row_slice(2, 2, &[-20.0 * p[0], 10.0 * self.unit, -1.0, 0.0]);
            quadratic.cost = 0.5 * r.norm_squared();
            quadratic.gradient = j.transpose() * &r;
            quadratic.hessian = j.transpose() * j;
        }
    }

    const LIMITS: Limits = Limits { iterations: 200, decrease: 1e-30, step: 1e-14, damping: CAUTIOUS };

    #[test]
    fn it_walks_through_rosenbrocks_valley() {
        let minimum = minimise(&mut Rosenbrock { unit: 1.0 }, &[-1.2, 1.0], &LIMITS, |_, _| ControlFlow::Continue(()));
        assert!((minimum.point[0] - 1.0).abs() < 1e-12 && (minimum.point[1] - 1.0).abs() < 1e-12, "{minimum:?}");
        assert!(minimum.iterations < 60, "{minimum:?}");
    }

    #[test]
    fn it_takes_the_same_path_in_any_units() {
        let path = |unit: f64| {
            let mut costs = Vec::new();
            minimise(&mut Rosenbrock { unit }, &[-1.2, unit.recip()], &LIMITS, |_, cost| {
                costs.push(cost);
                ControlFlow::Continue(())
            });
            costs
        };
        // Powers of two, so that the arithmetic is the same to the last bit.
        let units = [60, -60].map(|exponent| 2.0_f64.powi(exponent));
        assert!(units.iter().all(|unit| path(*unit) == path(1.0)));
    }

    /// A small bowl on a high floor: what can be gained is half a thousandth of the cost.
    struct Bowl;

    impl Problem for Bowl {
        fn parameters(&self) -> usize {
            1
        }

        fn cost(&mut self, p: &[f64]) -> f64 {
            1000.0 + 0.5 * (p[0] - 1.0).powi(2)
        }

        fn linearise(&mut self, p: &[f64], quadratic: &mut Quadratic) {
            quadratic.cost = self.cost(p);
            quadratic.gradient[0] = p[0] - 1.0;
            quadratic.hessian[(0, 0)] = 1.0;
        }
    }

    #[test]
    fn a_short_first_step_is_not_taken_for_the_end() {
        let limits = Limits { decrease: 1e-5, ..LIMITS };
        let minimum = minimise(&mut Bowl, &[0.0], &limits, |_, _| ControlFlow::Continue(()));
        assert!((minimum.point[0] - 1.0).abs() < 0.2, "{minimum:?}");
    }

    #[test]
    fn it_stops_when_told_to_and_keeps_what_it_had() {
        let mut seen = 0;
        let minimum = minimise(&mut Rosenbrock { unit: 1.0 }, &[-1.2, 1.0], &LIMITS, |_, _| {
            seen += 1;
            if seen == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(minimum.termination, Termination::Cancelled);
        assert!(minimum.cost < Rosenbrock { unit: 1.0 }.cost(&[-1.2, 1.0]));
    }
}
