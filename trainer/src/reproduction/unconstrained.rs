//! The paper's network trained by Levenberg–Marquardt and nothing else: no slope, no priors, no first-order instrument.
//!
//! The paper says gradient descent, which does not reach its tables within any patience; the second-order training of
//! the common toolboxes does. It shows what such tables are worth: three levels are learnt by heart.

use super::lesson::Lesson;
use crate::campaign::Run;
use crate::fit::dataset::{Datum, InputScale};
use crate::fit::levenberg_marquardt::{CAUTIOUS, Limits, Minimum, Problem, Quadratic, Termination, minimise};
use crate::fit::neighbours::merged;
use crate::fit::random::{between, stream};
use crate::model::Model;
use crate::progress::RestartNews;
use crate::train::{Method, Restart, TrainError, TrainSettings, Trained};
use firmware_core::activation::{sigmoid, slope};
use nalgebra::DVector;
use protocol::Weights;
use protocol::limits::{HIDDEN, WEIGHTS};
use rayon::prelude::*;
use std::ops::ControlFlow;

const LIMITS: Limits = Limits { iterations: 300, decrease: 1e-7, step: 1e-9, damping: CAUTIOUS };
/// First weights lie within plus and minus this, as those of the firefly swarms.
const WEIGHT_BOUND: f64 = 1.0;

/// Trains from random starts; the one with the least cost is kept.
pub(super) fn train(lesson: &Lesson) -> Result<Trained, TrainError> {
    // Everything of a model but its weights, and the baselines.
    let one = TrainSettings { restarts: 1, ..lesson.settings(Method::SecondOrder) };
    let mut trained = lesson.learn(&one)?;
    let runs = lesson.split.training.iter().filter_map(|&index| Some((index, lesson.campaign.runs.get(index)?)));
    let runs: Vec<(usize, &Run)> = runs.collect();
    let scale = InputScale::of(runs.iter().map(|(_, run)| *run)).ok_or(TrainError::NoTrainingRuns)?;
    let data = merged(runs.iter().copied(), &scale);
    let network = Network::new(&data);
    let minima: Vec<Minimum> =
        (0..lesson.restarts).into_par_iter().map(|index| network.clone().descend(lesson, index)).collect();
    trained.restarts = minima.iter().map(|minimum| network.restart(minimum)).collect();
    let best = minima.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).ok_or(TrainError::NoRestarts)?;
    network.write(&best.point, &mut trained.model);
    trained.model.provenance.restarts = lesson.restarts;
    "unconstrained".clone_into(&mut trained.model.provenance.method);
    Ok(trained)
}

/// Residuals of the 2-10-1 network over scaled data; references are scaled to ±1.
#[derive(Clone)]
struct Network<'a> {
    data: &'a [Datum],
    samples: f64,
    middle_g: f64,
    unit_g: f64,
}

impl<'a> Network<'a> {
    fn new(data: &'a [Datum]) -> Self {
        let references = || data.iter().map(|datum| datum.reference_g);
        let (low, high) = (references().fold(f64::MAX, f64::min), references().fold(f64::MIN, f64::max));
        Self {
            data,
            samples: data.iter().map(|datum| datum.weight).sum(),
            middle_g: f64::midpoint(low, high),
            unit_g: ((high - low) / 2.0).max(f64::EPSILON),
        }
    }

    fn descend(mut self, lesson: &Lesson, index: usize) -> Minimum {
        let random = &mut stream(lesson.seed, index as u64);
        let start: Vec<f64> = (0..WEIGHTS).map(|_| between(random, -WEIGHT_BOUND, WEIGHT_BOUND)).collect();
        let unit_g = self.unit_g;
        let news = |iteration, cost: f64, done| RestartNews {
            index,
            iteration,
            residual_g: (2.0 * cost).sqrt() * unit_g,
            noise_g: None,
            done,
        };
        let minimum = minimise(&mut self, &start, &LIMITS, |iteration, cost| {
            lesson.progress.restart(news(iteration, cost, false));
            if lesson.progress.cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        lesson.progress.restart(news(minimum.iterations, minimum.cost, true));
        minimum
    }

    fn residual(&self, weights: &[f64], datum: &Datum) -> f64 {
        let sum: f64 = (0..HIDDEN).map(|unit| weights[OUTPUT + unit] * sigmoid(argument(weights, unit, datum))).sum();
        sum + weights[WEIGHTS - 1] - (datum.reference_g - self.middle_g) / self.unit_g
    }

    fn restart(&self, minimum: &Minimum) -> Restart {
        Restart {
            residual_g: (2.0 * minimum.cost).sqrt() * self.unit_g,
            iterations: minimum.iterations,
            converged: minimum.termination != Termination::IterationLimit,
        }
    }

    fn write(&self, weights: &[f64], model: &mut Model) {
        let mut row = [0.0; WEIGHTS];
        row.iter_mut().zip(weights).for_each(|(slot, weight)| *slot = *weight as f32);
        let Weights { input, bias, output, output_bias } = Weights::from_array(&row);
        let network = &mut model.network;
        (network.input, network.bias, network.output, network.output_bias) = (input, bias, output, output_bias);
        model.scaling.line_g = [self.middle_g as f32, 0.0, 0.0, 0.0];
        model.scaling.output_g = self.unit_g as f32;
    }
}

/// Where thresholds and output weights begin among the weights.
const THRESHOLD: usize = 2 * HIDDEN;
const OUTPUT: usize = 3 * HIDDEN;

fn argument(weights: &[f64], unit: usize, datum: &Datum) -> f64 {
    weights[THRESHOLD + unit] + weights[2 * unit] * datum.x + weights[2 * unit + 1] * datum.t
}

/// Derivatives of the output by the weights.
fn gradient(weights: &[f64], datum: &Datum) -> DVector<f64> {
    let mut by = DVector::zeros(WEIGHTS);
    for unit in 0..HIDDEN {
        let u = argument(weights, unit, datum);
        let back = weights[OUTPUT + unit] * slope(u);
        by[2 * unit] = back * datum.x;
        by[2 * unit + 1] = back * datum.t;
        by[THRESHOLD + unit] = back;
        by[OUTPUT + unit] = sigmoid(u);
    }
    by[WEIGHTS - 1] = 1.0;
    by
}

impl Problem for Network<'_> {
    fn parameters(&self) -> usize {
        WEIGHTS
    }

    fn cost(&mut self, weights: &[f64]) -> f64 {
        let squares: f64 = self.data.iter().map(|datum| datum.weight * self.residual(weights, datum).powi(2)).sum();
        squares / (2.0 * self.samples)
    }

    fn linearise(&mut self, weights: &[f64], quadratic: &mut Quadratic) {
        quadratic.cost = self.cost(weights);
        quadratic.gradient.fill(0.0);
        quadratic.hessian.fill(0.0);
        for datum in self.data {
            let (by, weight) = (gradient(weights, datum), datum.weight / self.samples);
            quadratic.gradient.axpy(weight * self.residual(weights, datum), &by, 1.0);
            quadratic.hessian.ger(weight, &by, &by, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_that_of_the_cost() {
        let datum = |x: f64, t: f64| Datum { x, t, reference_g: x * (1.0 + 0.1 * t), weight: 2.0, run: 0 };
        let data = [datum(-1.0, 0.3), datum(0.1, -0.7), datum(0.8, 1.0)];
        let mut network = Network::new(&data);
        let random = &mut stream(3, 0);
        let weights: Vec<f64> = (0..WEIGHTS).map(|_| between(random, -1.0, 1.0)).collect();
        let mut quadratic = Quadratic::zeros(WEIGHTS);
        network.linearise(&weights, &mut quadratic);
        for index in 0..WEIGHTS {
            let mut shifted = |by: f64| {
                let mut weights = weights.clone();
                weights[index] += by;
                network.cost(&weights)
            };
            let numeric = (shifted(1e-5) - shifted(-1e-5)) / 2e-5;
            assert!((numeric - quadratic.gradient[index]).abs() < 1e-8, "weight {index}");
        }
    }
}
