//! The default: variable projection with Levenberg–Marquardt.

use super::search::{Candidate, Restart, Search};
use super::settings::Anchoring;
use super::task::Task;
use crate::fit::dataset::Datum;
use crate::fit::effects::{Coefficients, Frame, MovedRows};
use crate::fit::levenberg_marquardt::{CAUTIOUS, Limits, Termination, minimise};
use crate::fit::network::{
    Anchors, Fit, Group, HIDDEN_SIZE, NONLINEAR, NetworkProblem, OUTPUT_SIZE, Prior, Rows, SlopeRow, ValueRow,
};
use crate::fit::polynomial::{MOST_T, Polynomial};
use crate::fit::random::{between, stream};
use crate::noise::{Components, Mean};
use crate::progress::RestartNews;
use firmware_core::effect::Role;
use protocol::Weights;
use protocol::limits::HIDDEN;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// How far a resonator's slope may wander from the campaign's smooth scale factor before data must insist.
const SLOPE_ALLOWANCE: f64 = 300e-6;
/// How far the instrument may depart from a smooth one before data must insist, in units of its
/// departure from a line.
const VALUE_ALLOWANCE: f64 = 0.03;
/// Anchors stand on a grid of so many points along each input.
const ANCHOR_GRID: i32 = 9;
/// Steepest start of a hidden unit.
const STEEPEST_START: f64 = 2.5;
const LIMITS: Limits = Limits { iterations: 200, decrease: 1e-5, step: 1e-9, damping: CAUTIOUS };

/// Most often that networks are trained on with the scatter that the best of them leaves. Where the polynomial
/// misses much, the first network is still held too stiff to tell the noise; the second one rarely is.
const REFINEMENTS: usize = 6;
/// So many of the best restarts are trained on: which of them is best changes when data are believed more.
const LEADERS: usize = 5;
/// So many restarts are made before those that don't lead are forgotten.
const TOGETHER: usize = 16;
/// Scatter that falls to no less than this share has settled.
const SETTLED: f64 = 0.95;

/// Where along a shape's range, on a logarithmic scale, joint fits start.
const SHAPE_STARTS: [f64; 6] = [0.1, 0.25, 0.4, 0.55, 0.7, 0.85];
/// Amplitudes start as far from zero as gives shapes a slope to follow.
const FIRST_AMPLITUDE: f64 = 1e-6;

/// Trains from every start.
///
/// The polynomial tells a first time how much states and runs scatter, and so how far each may be
/// believed; the best network tells it better, and the leaders are trained on with that until the
/// scatter falls no further. Effects join the best network from several shapes and are fitted together
/// with it.
pub(super) fn search(task: &Task) -> Search {
    let first = Problem::new(task, &task.data, &task.noise(|datum| task.polynomial.evaluate(datum.x, datum.t)));
    let still = first.still_rows(task);
    let attempt = |index: usize| {
        let start = random_start(&mut stream(task.settings.seed, index as u64));
        descend(task, &first, still.clone(), index, &start)
    };
    // Some at a time: what a trial leaves is as large as the data, and only the leaders' is needed.
    let (mut restarts, mut leaders) = (Vec::new(), Vec::new());
    let mut next = 0;
    while next < task.settings.restarts && !task.progress.cancelled() {
        let end = task.settings.restarts.min(next.saturating_add(TOGETHER));
        let trials: Vec<Trial> = (next..end).into_par_iter().filter_map(attempt).collect();
        restarts.extend(trials.iter().map(|trial| trial.restart));
        leaders = leading(leaders.into_iter().chain(trials).collect());
        next = end;
    }
    let best = with_effects(task, &first, leaders);
    Search { restarts, best: refined(task, first, best) }
}

/// Trains the leaders on, each time with the scatter that the best of them leaves.
fn refined(task: &Task, first: Problem, leaders: Vec<Trial>) -> Option<Candidate> {
    let (mut problem, mut leaders) = (first, leaders);
    for _ in 0..REFINEMENTS {
        let best = leaders.first()?;
        let known = Problem::new(task, &best.data, &Components::estimate(task.sigma_g, &best.scatter));
        let attempt =
            |(place, leader): (usize, &Trial)| known.descend_moved(task, task.settings.restarts + place, &leader.point);
        let trained = leading(leaders.par_iter().enumerate().filter_map(attempt).collect());
        let Some(next) = trained.first() else { break };
        let settled = rms(&next.scatter) > SETTLED * rms(&best.scatter);
        (problem, leaders) = (known, trained);
        if settled {
            break;
        }
    }
    leaders.first().map(|best| problem.candidate(task, best))
}

/// The trials of least cost, best first; the first of equals, so that the number of threads doesn't matter.
fn leading(mut trials: Vec<Trial>) -> Vec<Trial> {
    trials.retain(|trial| trial.cost.is_finite());
    trials.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    trials.truncate(LEADERS);
    trials
}

/// Fits the task's effects together with the network, from several shapes.
fn with_effects(task: &Task, problem: &Problem, leaders: Vec<Trial>) -> Vec<Trial> {
    if task.effects.is_empty() {
        return leaders;
    }
    let Some(hidden) = leaders.first().and_then(|best| best.point.get(..NONLINEAR)) else { return Vec::new() };
    let attempt = |(index, start): (usize, Vec<f64>)| {
        let point: Vec<f64> = hidden.iter().chain(&start).copied().collect();
        problem.descend_moved(task, task.settings.restarts + index, &point)
    };
    let starts: Vec<_> = effect_starts(task).into_iter().enumerate().collect();
    // One leader: with effects every row's history is computed anew at each step.
    leading(starts.into_par_iter().filter_map(attempt).collect()).into_iter().take(1).collect()
}

/// Effects known from an earlier model start where they were, the others at each of [`SHAPE_STARTS`].
fn effect_starts(task: &Task) -> Vec<Vec<f64>> {
    let known = |index: usize| task.settings.effects.get(index).and_then(|choice| choice.start.clone());
    let start = |part: f64| {
        let of = |(index, effect): (usize, &crate::fit::effects::Chosen)| {
            known(index).unwrap_or_else(|| {
                let first = |about: &firmware_core::effect::Parameter| match about.role {
                    Role::Amplitude => FIRST_AMPLITUDE / effect.size,
                    Role::Shape => about.low * (about.high / about.low).powf(part),
                    Role::Origin => effect.origin,
                    Role::Location => about.low + (about.high - about.low) * part,
                };
                effect.about.parameters.iter().map(first).collect()
            })
        };
        Coefficients { values: task.effects.iter().enumerate().map(of).collect() }.to_parameters(&task.effects)
    };
    let mut starts: Vec<Vec<f64>> = SHAPE_STARTS.into_iter().map(start).collect();
    starts.dedup();
    starts
}

/// Where one descent ended.
struct Trial {
    restart: Restart,
    cost: f64,
    point: Vec<f64>,
    fit: Fit,
    scatter: Vec<Mean>,
    /// The training data with the effects' share taken out.
    data: Vec<Datum>,
}

fn descend(task: &Task, problem: &Problem, rows: impl Rows, index: usize, start: &[f64]) -> Option<Trial> {
    if task.progress.cancelled() {
        return None;
    }
    let weigh = |of: fn(&ValueRow) -> f64| rows.groups().iter().flat_map(|group| &group.rows).map(of).sum::<f64>();
    let weight = weigh(|row| row.weight);
    let noise_g = Some(task.yardstick.outside(task.sigma_g) * (weigh(|row| row.weight / row.samples) / weight).sqrt());
    let mut network = NetworkProblem::new(rows, &problem.anchors, problem.prior);
    let report = |iteration, cost: f64, done| {
        let residual_g = (2.0 * cost / weight).sqrt() * task.yardstick.outside(problem.unit_g);
        task.progress.restart(RestartNews { index, iteration, residual_g, noise_g, done });
    };
    let minimum = minimise(&mut network, start, &LIMITS, |iteration, cost| {
        report(iteration, cost, false);
        if task.progress.cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    report(minimum.iterations, minimum.cost, true);
    let fit = network.fit(&minimum.point)?;
    let scatter = scatter(network.rows(), &fit, problem.unit_g);
    let data = problem.undisturbed(network.rows());
    let restart = Restart {
        residual_g: rms(&scatter),
        iterations: minimum.iterations,
        converged: minimum.termination != Termination::IterationLimit,
    };
    Some(Trial { restart, cost: minimum.cost, point: minimum.point, fit, scatter, data })
}

/// Residuals of the rows' means.
fn scatter(rows: &impl Rows, fit: &Fit, unit_g: f64) -> Vec<Mean> {
    let mut means = Vec::new();
    for (run, group) in rows.groups().iter().enumerate() {
        means.extend(group.rows.iter().map(|row| Mean {
            run,
            samples: row.samples,
            residual_g: (fit.evaluate(row.x, row.t) - row.y) * unit_g,
        }));
    }
    means
}

/// RMS over the samples that the means stand for, g.
fn rms(means: &[Mean]) -> f64 {
    let squares: f64 = means.iter().map(|mean| mean.samples * mean.residual_g.powi(2)).sum();
    let samples: f64 = means.iter().map(|mean| mean.samples).sum();
    (squares / samples).sqrt()
}

/// The task in the units of its departure from a line.
struct Problem {
    noise: Components,
    anchors: Anchors,
    prior: Prior,
    line: Polynomial,
    unit_g: f64,
}

impl Problem {
    /// The problem of `data`, whose effects were taken out as far as they are known.
    fn new(task: &Task, data: &[Datum], noise: &Components) -> Self {
        let stated_g = task.settings.scale_factor_hz_per_g.map(|stated| task.scale.delta_f_half_span_hz / stated);
        let line = stated_g
            .map_or_else(|| Polynomial::fit_degrees(data, 1, 1), |slope_g| Polynomial::fit_still(data, slope_g, 1));
        let departure = |datum: &Datum| Mean {
            run: datum.run,
            samples: datum.weight,
            residual_g: datum.reference_g - line.evaluate(datum.x, datum.t),
        };
        let unit_g = rms(&data.iter().map(departure).collect::<Vec<_>>()).max(noise.sample_g);
        let unit_variance = (noise.sample_g / unit_g).powi(2);
        let weight = |datum: &Datum| noise.weight(datum.run, datum.weight);
        let smooth = stated_g.map_or_else(
            || Polynomial::fit_mixed(data, weight, noise.run_variance()),
            |slope_g| Polynomial::fit_still(data, slope_g, MOST_T),
        );
        Self {
            anchors: anchors(task, &smooth, &line, unit_g),
            noise: noise.clone(),
            prior: Prior { output: unit_variance / OUTPUT_SIZE.powi(2), hidden: unit_variance / HIDDEN_SIZE.powi(2) },
            line,
            unit_g,
        }
    }

    /// The rows where the effects have moved them, as data.
    fn undisturbed(&self, rows: &impl Rows) -> Vec<Datum> {
        let mut data = Vec::new();
        for (run, group) in rows.groups().iter().enumerate() {
            data.extend(group.rows.iter().map(|row| Datum {
                x: row.x,
                t: row.t,
                reference_g: row.y * self.unit_g + self.line.evaluate(row.x, row.t),
                weight: row.samples,
                run,
            }));
        }
        data
    }

    fn moved_rows<'a>(&self, task: &'a Task) -> MovedRows<'a> {
        let frame =
            Frame { scale: task.scale, line: self.line.clone(), unit_g: self.unit_g, max_gap_us: task.max_gap_us };
        MovedRows::new(&task.runs, &task.effects, frame, &self.noise)
    }

    fn still_rows(&self, task: &Task) -> Vec<Group> {
        self.moved_rows(task).still()
    }

    fn descend_moved(&self, task: &Task, index: usize, start: &[f64]) -> Option<Trial> {
        if task.effects.is_empty() {
            return descend(task, self, self.still_rows(task), index, start);
        }
        descend(task, self, self.moved_rows(task), index, start)
    }

    fn candidate(&self, task: &Task, trial: &Trial) -> Candidate {
        let mut weights = Weights::ZERO;
        for (unit, [wx, wt, b]) in trial.fit.hidden.as_chunks::<3>().0.iter().enumerate().take(HIDDEN) {
            weights.input[unit] = [*wx as f32, *wt as f32];
            weights.bias[unit] = *b as f32;
            weights.output[unit] = trial.fit.output[unit] as f32;
        }
        let mut line_g = self.line.bilinear();
        for (value, share) in line_g.iter_mut().zip(trial.fit.line) {
            *value += share * self.unit_g;
        }
        let parameters = trial.point.get(NONLINEAR..).unwrap_or_default();
        Candidate {
            restart: trial.restart,
            cost: trial.cost,
            line_g,
            output_g: self.unit_g,
            weights,
            coefficients: Coefficients::from_parameters(&task.effects, parameters),
        }
    }
}

/// On a grid over the domain: the smooth instrument's values and slopes.
///
/// The slope is the scale factor that the campaign itself measured, or the stated one of a sensor
/// that lay still.
fn anchors(task: &Task, smooth: &Polynomial, line: &Polynomial, unit_g: f64) -> Anchors {
    let grid = || (0..ANCHOR_GRID).map(|k| 2.0 * f64::from(k) / f64::from(ANCHOR_GRID - 1) - 1.0);
    let weight = |sigma_g: f64| (task.sigma_g / sigma_g).powi(2);
    let mut anchors = Anchors::default();
    let anchoring = task.settings.anchoring;
    let still = task.settings.scale_factor_hz_per_g.is_some();
    for (x, t) in grid().flat_map(|x| grid().map(move |t| (x, t))) {
        let (slope_g, measured_g) = match task.settings.scale_factor_hz_per_g {
            Some(stated) => (task.scale.delta_f_half_span_hz / stated, 0.0),
            None => (smooth.slope(x, t), smooth.slope_sigma(x, t, task.sigma_g)),
        };
        if matches!(anchoring, Anchoring::Slopes | Anchoring::Both) {
            anchors.slopes.push(SlopeRow {
                x,
                t,
                slope: (slope_g - line.slope(x, t)) / unit_g,
                weight: weight(measured_g.hypot(SLOPE_ALLOWANCE * slope_g)),
            });
        }
        let measured_g = smooth.value_sigma(x, t, task.sigma_g);
        if matches!(anchoring, Anchoring::Values | Anchoring::Both) && !still {
            anchors.values.push(ValueRow {
                x,
                t,
                y: (smooth.evaluate(x, t) - line.evaluate(x, t)) / unit_g,
                weight: weight(measured_g.hypot(VALUE_ALLOWANCE * unit_g)),
                samples: 0.0,
            });
        }
    }
    anchors
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
