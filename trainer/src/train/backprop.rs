//! The paper's training: a firefly swarm finds first weights, gradient descent improves them.
//!
//! Huang et al. 2022, §2.3 and Figure 5. Inputs and reference are scaled to ±1; all 41 weights are
//! searched within one box, then descended by the gradient of eq. (3). It works on the same merged
//! data as the default, each mean weighted by its samples, which changes the cost by nothing that
//! gradient descent could resolve and makes 30 restarts affordable.

use super::error::TrainError;
use super::search::{Candidate, Restart, Search};
use super::settings::{Backprop, Swarm};
use super::task::Task;
use crate::fit::dataset::Datum;
use crate::fit::effects::Coefficients;
use crate::fit::firefly::{self, Domain};
use crate::fit::gradient_descent::{self, Termination};
use crate::fit::random::stream;
use crate::progress::RestartNews;
use firmware_core::activation::{sigmoid, slope};
use protocol::Weights;
use protocol::limits::{HIDDEN, WEIGHTS};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// So many restarts are made at once, however many there are to be.
const TOGETHER: usize = 64;

/// Trains from every swarm.
pub(super) fn search(task: &Task, settings: &Backprop) -> Result<Search, TrainError> {
    let problem = Problem::new(task);
    let attempt = |index: usize| {
        if task.progress.cancelled() {
            return Ok(None);
        }
        restart(task, &problem, settings, index).map(Some)
    };
    let mut candidates = Vec::new();
    let mut next = 0;
    while next < task.settings.restarts && !task.progress.cancelled() {
        let end = task.settings.restarts.min(next.saturating_add(TOGETHER));
        let some = (next..end).into_par_iter().map(attempt).collect::<Result<Vec<_>, _>>()?;
        candidates.extend(some.into_iter().flatten());
        next = end;
    }
    Ok(Search::of(candidates))
}

fn restart(task: &Task, problem: &Problem, settings: &Backprop, index: usize) -> Result<Candidate, TrainError> {
    let go_on = || if task.progress.cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let mut random = stream(task.settings.seed, index as u64);
    let domain = Domain::cube(WEIGHTS, &(-settings.weight_bound..=settings.weight_bound))?;
    let cost = |weights: &[f64]| problem.cost(weights);
    let first = match &settings.swarm {
        Swarm::Standard(swarm) => firefly::standard(cost, &domain, swarm, &mut random, |_, _| go_on())?,
        Swarm::Improved(swarm) => firefly::improved(cost, &domain, swarm, &mut random, |_, _| go_on())?,
    };
    let descend = |weights: &[f64], gradient: &mut [f64]| problem.cost_and_gradient(weights, gradient);
    let noise_g = Some(task.yardstick.outside(task.sigma_g) * (problem.data.len() as f64 / problem.samples).sqrt());
    let report = |iteration: usize, cost: f64, done: bool| {
        let residual_g = (2.0 * cost).sqrt() * task.yardstick.outside(problem.unit_g);
        task.progress.restart(RestartNews { index, iteration, residual_g, noise_g, done });
    };
    let minimum = gradient_descent::minimise(descend, &first.best, &settings.descent, |iteration, cost| {
        if iteration % 100 == 0 {
            report(iteration, cost, false);
        }
        go_on()
    })?;
    report(minimum.iterations, minimum.cost, true);
    Ok(problem.candidate(&minimum))
}

/// Mean squared error of the scaled output, and its gradient.
struct Problem<'a> {
    data: &'a [Datum],
    samples: f64,
    middle_g: f64,
    unit_g: f64,
}

impl<'a> Problem<'a> {
    /// References are scaled to ±1 over the training data.
    fn new(task: &'a Task) -> Self {
        let references = || task.data.iter().map(|datum| datum.reference_g);
        let (low, high) = (references().fold(f64::MAX, f64::min), references().fold(f64::MIN, f64::max));
        Self {
            data: &task.data,
            samples: task.data.iter().map(|datum| datum.weight).sum(),
            middle_g: f64::midpoint(low, high),
            unit_g: ((high - low) / 2.0).max(task.sigma_g),
        }
    }

    /// Half the mean square, eq. (3).
    fn cost(&self, weights: &[f64]) -> f64 {
        let squares: f64 = self.data.iter().map(|datum| datum.weight * self.residual(weights, datum).powi(2)).sum();
        squares / (2.0 * self.samples)
    }

    fn residual(&self, weights: &[f64], datum: &Datum) -> f64 {
        let (inputs, rest) = weights.split_at(2 * HIDDEN);
        let (biases, rest) = rest.split_at(HIDDEN);
        let (outputs, output_bias) = rest.split_at(HIDDEN);
        let units = inputs.as_chunks::<2>().0.iter().zip(biases).zip(outputs);
        let sum: f64 = units.map(|(([wx, wt], b), v)| v * sigmoid(b + wx * datum.x + wt * datum.t)).sum();
        sum + output_bias[0] - (datum.reference_g - self.middle_g) / self.unit_g
    }

    /// Backpropagation.
    fn cost_and_gradient(&self, weights: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        let mut squares = 0.0;
        for datum in self.data {
            let residual = self.residual(weights, datum);
            squares += datum.weight * residual * residual;
            let error = datum.weight / self.samples * residual;
            for unit in 0..HIDDEN {
                let (wx, wt) = (weights[2 * unit], weights[2 * unit + 1]);
                let (bias, output) = (2 * HIDDEN + unit, 3 * HIDDEN + unit);
                let u = weights[bias] + wx * datum.x + wt * datum.t;
                let back = error * weights[output] * slope(u);
                gradient[2 * unit] += back * datum.x;
                gradient[2 * unit + 1] += back * datum.t;
                gradient[bias] += back;
                gradient[output] += error * sigmoid(u);
            }
            gradient[WEIGHTS - 1] += error;
        }
        squares / (2.0 * self.samples)
    }

    fn candidate(&self, minimum: &gradient_descent::Minimum) -> Candidate {
        let mut row = [0.0; WEIGHTS];
        row.iter_mut().zip(&minimum.point).for_each(|(slot, weight)| *slot = *weight as f32);
        Candidate {
            restart: Restart {
                residual_g: (2.0 * minimum.cost).sqrt() * self.unit_g,
                iterations: minimum.iterations,
                converged: minimum.termination != Termination::IterationLimit,
            },
            cost: minimum.cost,
            line_g: [self.middle_g, 0.0, 0.0, 0.0],
            output_g: self.unit_g,
            weights: Weights::from_array(&row),
            coefficients: Coefficients { values: Vec::new() },
        }
    }
}
