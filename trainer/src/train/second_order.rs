//! The default: variable projection with Levenberg–Marquardt.

use super::{Candidate, Restart, Search, Task};
use crate::fit::dataset::Datum;
use crate::fit::levenberg_marquardt::{Limits, Termination, minimise};
use crate::fit::network::{Fit, Group, NetworkProblem, Prior, SlopeRow, ValueRow};
use crate::fit::polynomial::Polynomial;
use crate::fit::random::{between, stream};
use crate::noise::Components;
use crate::progress::RestartNews;
use protocol::Weights;
use protocol::limits::HIDDEN;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Expected size of an output weight, in units of the departure from the line.
const OUTPUT_SIZE: f64 = 10.0;
/// Expected size of a hidden weight. A unit this steep bends over the whole domain: an instrument is
/// smooth until data insist on the contrary. `docs/decisions/0003-priors.md` has the comparison.
const HIDDEN_SIZE: f64 = 1.0;
/// How far a resonator's slope may wander from the campaign's smooth scale factor before data must insist.
const SLOPE_ALLOWANCE: f64 = 300e-6;
/// The slope is held on a grid of so many points along each input.
const SLOPE_GRID: i32 = 7;
/// Steepest start of a hidden unit.
const STEEPEST_START: f64 = 2.5;
const LIMITS: Limits = Limits { iterations: 200, decrease: 1e-5, step: 1e-9 };

/// Trains from every start.
///
/// The polynomial tells a first time how much states and runs scatter, and so how far each may be
/// believed; the best network tells it better, and is trained on with that.
pub(super) fn search(task: &Task) -> Search {
    let first = Problem::new(task, &task.noise(|datum| task.polynomial.evaluate(datum.x, datum.t)));
    let attempt = |index: usize| {
        if task.progress.cancelled() {
            return None;
        }
        descend(task, &first, index, &random_start(&mut stream(task.settings.seed, index as u64)))
    };
    let candidates = (0..task.settings.restarts).into_par_iter().filter_map(attempt).collect();
    let Search { restarts, best } = Search::of(candidates);
    let refined = best.as_ref().and_then(|best| {
        let known = Problem::new(task, &task.noise(|datum| best.evaluate_g(datum.x, datum.t)));
        descend(task, &known, task.settings.restarts, &best.hidden())
    });
    Search { restarts, best: refined.or(best) }
}

fn descend(task: &Task, problem: &Problem, index: usize, start: &[f64]) -> Option<Candidate> {
    let mut network = NetworkProblem::new(&problem.groups, &problem.slopes, problem.prior);
    let report = |iteration, cost: f64, done| {
        let residual_g = (2.0 * cost / problem.weight).sqrt() * problem.unit_g;
        task.progress.restart(RestartNews { index, iteration, residual_g, done });
    };
    let minimum = minimise(&mut network, start, &LIMITS, |iteration, cost| {
        report(iteration, cost, false);
        if task.progress.cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    report(minimum.iterations, minimum.cost, true);
    let fit = network.fit(&minimum.point)?;
    let residual_g = problem.residual_g(task, &fit);
    let converged = minimum.termination != Termination::IterationLimit;
    let restart = Restart { residual_g, iterations: minimum.iterations, converged };
    Some(problem.candidate(&fit, restart, minimum.cost))
}

/// The task in the units of its departure from a line.
struct Problem {
    groups: Vec<Group>,
    slopes: Vec<SlopeRow>,
    prior: Prior,
    /// Of all rows.
    weight: f64,
    line: Polynomial,
    unit_g: f64,
}

impl Problem {
    fn new(task: &Task, noise: &Components) -> Self {
        let line = Polynomial::fit_degrees(&task.data, 1, 1);
        let departure_g = |datum: &Datum| datum.reference_g - line.evaluate(datum.x, datum.t);
        let unit_g = rms_weighted(&task.data, departure_g).max(noise.sample_g);
        let row = |datum: &Datum| ValueRow {
            x: datum.x,
            t: datum.t,
            y: departure_g(datum) / unit_g,
            weight: noise.weight(datum.weight),
        };
        let runs = task.data.chunk_by(|a, b| a.run == b.run);
        let group =
            |run: &[Datum]| Group { rows: run.iter().map(row).collect(), offset_variance: noise.run_variance() };
        let groups: Vec<Group> = runs.map(group).collect();
        let unit_variance = (noise.sample_g / unit_g).powi(2);
        Self {
            slopes: slope_rows(task, &line, unit_g),
            prior: Prior { output: unit_variance / OUTPUT_SIZE.powi(2), hidden: unit_variance / HIDDEN_SIZE.powi(2) },
            weight: groups.iter().flat_map(|group| &group.rows).map(|row| row.weight).sum(),
            groups,
            line,
            unit_g,
        }
    }

    fn evaluate_g(&self, fit: &Fit, x: f64, t: f64) -> f64 {
        self.line.evaluate(x, t) + self.unit_g * fit.evaluate(x, t)
    }

    /// RMS over the training samples, g.
    fn residual_g(&self, task: &Task, fit: &Fit) -> f64 {
        rms_weighted(&task.data, |datum| self.evaluate_g(fit, datum.x, datum.t) - datum.reference_g)
    }

    fn candidate(&self, fit: &Fit, restart: Restart, cost: f64) -> Candidate {
        let mut weights = Weights::ZERO;
        for (unit, [wx, wt, b]) in fit.hidden.as_chunks::<3>().0.iter().enumerate().take(HIDDEN) {
            weights.input[unit] = [*wx as f32, *wt as f32];
            weights.bias[unit] = *b as f32;
            weights.output[unit] = fit.output[unit] as f32;
        }
        let mut line_g = self.line.bilinear();
        for (value, share) in line_g.iter_mut().zip(fit.line) {
            *value += share * self.unit_g;
        }
        Candidate { restart, cost, line_g, output_g: self.unit_g, weights }
    }
}

/// Root mean square of a value over the samples that the data stand for.
fn rms_weighted(data: &[Datum], value: impl Fn(&Datum) -> f64) -> f64 {
    let squares: f64 = data.iter().map(|datum| datum.weight * value(datum).powi(2)).sum();
    let samples: f64 = data.iter().map(|datum| datum.weight).sum();
    (squares / samples).sqrt()
}

/// Asks on a grid that the slope be the scale factor that the campaign itself measured.
fn slope_rows(task: &Task, line: &Polynomial, unit_g: f64) -> Vec<SlopeRow> {
    let grid = || (0..SLOPE_GRID).map(|k| 2.0 * f64::from(k) / f64::from(SLOPE_GRID - 1) - 1.0);
    let mut rows = Vec::new();
    for (x, t) in grid().flat_map(|x| grid().map(move |t| (x, t))) {
        let (wanted, measured_sigma) = match task.settings.scale_factor_hz_per_g {
            Some(stated) => (task.scale.delta_f_half_span_hz / stated, 0.0),
            None => (task.polynomial.slope(x, t), task.polynomial.slope_sigma(x, t, task.sigma_g)),
        };
        let sigma = measured_sigma.hypot(SLOPE_ALLOWANCE * wanted);
        let weight = (task.sigma_g / sigma).powi(2);
        rows.push(SlopeRow { x, t, slope: (wanted - line.slope(x, t)) / unit_g, weight });
    }
    rows
}

/// Units whose steepest place lies within the domain, in random directions.
fn random_start(random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let mut hidden = Vec::with_capacity(3 * HIDDEN);
    for _ in 0..HIDDEN {
        let [wx, wt] = [0; 2].map(|_| between(random, -STEEPEST_START, STEEPEST_START));
        let [x, t] = [0; 2].map(|_| between(random, -1.0, 1.0));
        hidden.extend([wx, wt, -(wx * x + wt * t)]);
    }
    hidden
}
