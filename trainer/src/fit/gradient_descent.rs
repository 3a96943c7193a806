//! Gradient descent, the "BP" after eq. (3) of the paper (Huang et al., Micromachines 2022, 13, 1054, §2.1).
//!
//! Separate, because it is here to be compared with. The paper prints neither learning rate nor number of
//! iterations and stops when "the error or the number of iterations reaches the set value"; both are
//! settings. Momentum and the "bold driver" rate (Vogl et al., Biol. Cybern. 1988, 59, 257; Battiti, Complex
//! Systems 1989, 3, 331) are the customary repairs.

use std::ops::ControlFlow;
use thiserror::Error;

/// Bold driver: factor on the rate after a step that did not raise the cost, and after one that did.
const GROW: f64 = 1.05;
const SHRINK: f64 = 0.5;

/// How far a step goes along the negative gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LearningRate {
    /// Always the same: the paper's. Diverges from twice the inverse of the largest curvature on.
    Fixed(f64),
    /// Grows by 5 % while the cost falls; a step that raises it is taken back and the rate halved.
    BoldDriver(f64),
}

/// How to descend and when to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The step length.
    pub rate: LearningRate,
    /// Fraction of the last step that is repeated, from 0 to below 1. The paper has none.
    pub momentum: f64,
    /// Most iterations, rejected steps included.
    pub iterations: usize,
    /// Stop when the cost is no higher than this.
    pub target_cost: Option<f64>,
}

impl Settings {
    /// The paper's plain descent, with the two numbers that it does not print.
    #[must_use]
    pub fn paper(learning_rate: f64, iterations: usize) -> Self {
        Self { rate: LearningRate::Fixed(learning_rate), momentum: 0.0, iterations, target_cost: None }
    }

    /// The bold driver from a first rate, without momentum.
    #[must_use]
    pub fn bold_driver(first_rate: f64, iterations: usize) -> Self {
        Self { rate: LearningRate::BoldDriver(first_rate), ..Self::paper(first_rate, iterations) }
    }

    fn check(&self) -> Result<(), DescentError> {
        let (LearningRate::Fixed(rate) | LearningRate::BoldDriver(rate)) = self.rate;
        let refuse = |setting, found, expected| Err(DescentError { setting, found, expected });
        if !(rate > 0.0 && rate.is_finite()) {
            return refuse("rate", rate, "finite and above 0");
        }
        if !(0.0..1.0).contains(&self.momentum) {
            return refuse("momentum", self.momentum, "at least 0 and below 1");
        }
        Ok(())
    }
}

/// A setting with which nothing can be descended.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{setting} is {found}; it must be {expected}")]
pub struct DescentError {
    /// The setting.
    pub setting: &'static str,
    /// Its value.
    pub found: f64,
    /// What would do.
    pub expected: &'static str,
}

/// Why the descent ended. None of them is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The target cost was reached.
    TargetCost,
    /// The limit on iterations was reached.
    IterationLimit,
    /// Steps no longer move the point: the gradient is zero or the rate has become too small.
    Stalled,
    /// The cost or the gradient is not finite: a fixed rate is too large, or the start is out of bounds.
    Diverged,
    /// The observer asked to stop.
    Cancelled,
}

/// Where the descent ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// The point with the lowest cost met: the last one, unless a fixed rate oscillates or diverges.
    pub point: Vec<f64>,
    /// The cost there.
    pub cost: f64,
    /// The cost at the start and after each iteration, as long as it was finite.
    pub history: Vec<f64>,
    /// Iterations made, rejected steps included.
    pub iterations: usize,
    /// Why it ended.
    pub termination: Termination,
}

/// Minimises a function from `start`. `cost_and_gradient` returns the cost at a point and fills in the
/// gradient there. After each iteration `observe` sees iteration and cost, and may stop.
///
/// # Errors
/// [`DescentError`] when a setting is out of its range.
pub fn minimise(
    cost_and_gradient: impl FnMut(&[f64], &mut [f64]) -> f64,
    start: &[f64],
    settings: &Settings,
    mut observe: impl FnMut(usize, f64) -> ControlFlow<()>,
) -> Result<Minimum, DescentError> {
    settings.check()?;
    let mut descent = Descent::new(cost_and_gradient, start, settings);
    if !is_finite(descent.here.cost, &descent.here.gradient) {
        return Ok(descent.finish(0, Termination::Diverged));
    }
    descent.history.push(descent.here.cost);
    for iteration in 1..=settings.iterations {
        if let Some(termination) = descent.end().or_else(|| descent.step()) {
            return Ok(descent.finish(iteration - 1, termination));
        }
        descent.history.push(descent.here.cost);
        if observe(iteration, descent.here.cost).is_break() {
            return Ok(descent.finish(iteration, Termination::Cancelled));
        }
    }
    let termination = descent.end().unwrap_or(Termination::IterationLimit);
    Ok(descent.finish(settings.iterations, termination))
}

#[derive(Clone)]
struct Place {
    point: Vec<f64>,
    gradient: Vec<f64>,
    cost: f64,
}

struct Descent<'s, F> {
    cost_and_gradient: F,
    settings: &'s Settings,
    rate: f64,
    here: Place,
    trial: Place,
    velocity: Vec<f64>,
    best: (Vec<f64>, f64),
    history: Vec<f64>,
}

impl<'s, F: FnMut(&[f64], &mut [f64]) -> f64> Descent<'s, F> {
    fn new(mut cost_and_gradient: F, start: &[f64], settings: &'s Settings) -> Self {
        let mut gradient = vec![0.0; start.len()];
        let cost = cost_and_gradient(start, &mut gradient);
        let here = Place { point: start.to_vec(), gradient, cost };
        let (LearningRate::Fixed(rate) | LearningRate::BoldDriver(rate)) = settings.rate;
        Self {
            cost_and_gradient,
            settings,
            rate,
            trial: here.clone(),
            velocity: vec![0.0; start.len()],
            best: (start.to_vec(), cost),
            history: Vec::new(),
            here,
        }
    }

    /// Whether the present place is a place to stop.
    fn end(&self) -> Option<Termination> {
        let target = self.settings.target_cost?;
        (self.here.cost <= target).then_some(Termination::TargetCost)
    }

    /// One step, taken or taken back, or the reason why there is none.
    fn step(&mut self) -> Option<Termination> {
        self.propose();
        if self.stuck() {
            return Some(Termination::Stalled);
        }
        self.trial.cost = (self.cost_and_gradient)(&self.trial.point, &mut self.trial.gradient);
        let finite = is_finite(self.trial.cost, &self.trial.gradient);
        match self.settings.rate {
            LearningRate::Fixed(_) if !finite => return Some(Termination::Diverged),
            LearningRate::Fixed(_) => self.accept(),
            LearningRate::BoldDriver(_) if finite && self.trial.cost <= self.here.cost => {
                self.accept();
                self.rate *= GROW;
            }
            LearningRate::BoldDriver(_) => {
                self.velocity.fill(0.0);
                self.rate *= SHRINK;
            }
        }
        None
    }

    /// v ← μ·v − η·∂C/∂x, x' = x + v.
    fn propose(&mut self) {
        for (velocity, slope) in self.velocity.iter_mut().zip(&self.here.gradient) {
            *velocity = self.settings.momentum * *velocity - self.rate * slope;
        }
        let moves = self.here.point.iter().zip(&self.velocity);
        for (trial, (x, velocity)) in self.trial.point.iter_mut().zip(moves) {
            *trial = x + velocity;
        }
    }

    /// Whether neither this step nor a later one from here can move: with momentum, steps too small to
    /// move may still add up, unless the gradient is zero.
    fn stuck(&self) -> bool {
        self.trial.point == self.here.point
            && (self.settings.momentum == 0.0 || self.here.gradient.iter().all(|slope| *slope == 0.0))
    }

    fn accept(&mut self) {
        std::mem::swap(&mut self.here, &mut self.trial);
        if self.here.cost < self.best.1 {
            self.best.0.copy_from_slice(&self.here.point);
            self.best.1 = self.here.cost;
        }
    }

    fn finish(self, iterations: usize, termination: Termination) -> Minimum {
        let (point, cost) = self.best;
        Minimum { point, cost, history: self.history, iterations, termination }
    }
}

fn is_finite(cost: f64, gradient: &[f64]) -> bool {
    cost.is_finite() && gradient.iter().all(|slope| slope.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVATURES: [f64; 3] = [0.1, 1.0, 4.0];
    const START: [f64; 3] = [1.0, -2.0, 3.0];

    /// ½ Σ λ x², whose descent is known in closed form.
    fn quadratic(x: &[f64], gradient: &mut [f64]) -> f64 {
        for (i, curvature) in CURVATURES.into_iter().enumerate() {
            gradient[i] = curvature * x[i];
        }
        x.iter().zip(gradient).map(|(x, slope)| 0.5 * x * *slope).sum()
    }

    fn go_on(_: usize, _: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn descend(settings: &Settings) -> Minimum {
        minimise(quadratic, &START, settings, go_on).unwrap()
    }

    #[test]
    fn a_fixed_rate_descends_a_quadratic_at_the_analytic_rate() {
        const RATE: f64 = 0.3;
        const ROUNDING: f64 = 1e-13;
        let minimum = descend(&Settings::paper(RATE, 40));
        let distance = |start: f64, curvature: f64, n| start * (1.0 - RATE * curvature).powi(n);
        for (cost, n) in minimum.history.iter().zip(0..) {
            let x = START.iter().zip(CURVATURES);
            let terms = x.map(|(x, c)| 0.5 * c * distance(*x, c, n).powi(2));
            let analytic: f64 = terms.sum();
            assert!((cost / analytic - 1.0).abs() < ROUNDING, "iteration {n}");
        }
        assert_eq!(minimum.termination, Termination::IterationLimit);
        assert_eq!((minimum.iterations, minimum.history.len()), (40, 41));
    }

    /// One coordinate oscillates by a 2×2 matrix with determinant μ: x(n+1)·x(n−1) − x(n)² shrinks by μ.
    #[test]
    fn momentum_shrinks_the_oscillation_at_the_analytic_rate() {
        const MOMENTUM: f64 = 0.8;
        let mut settings = Settings::paper(0.3, 30);
        settings.momentum = MOMENTUM;
        let mut path = Vec::new();
        let parabola = |x: &[f64], gradient: &mut [f64]| {
            path.push(x[0]);
            gradient[0] = x[0];
            0.5 * x[0] * x[0]
        };
        minimise(parabola, &[1.0], &settings, go_on).unwrap();
        let areas: Vec<f64> = path.windows(3).map(|x| x[2] * x[0] - x[1] * x[1]).collect();
        assert_eq!(areas.len(), 29);
        let mut ratios = areas.windows(2).map(|pair| pair[1] / pair[0]);
        assert!(ratios.all(|ratio| (ratio - MOMENTUM).abs() < 1e-9));
    }

    #[test]
    fn a_rate_above_twice_the_inverse_curvature_diverges_and_the_best_point_is_kept() {
        let minimum = descend(&Settings::paper(0.51, 100_000));
        assert_eq!(minimum.termination, Termination::Diverged);
        let lowest = minimum.history.iter().copied().reduce(f64::min);
        assert_eq!(Some(minimum.cost), lowest);
        assert_eq!(quadratic(&minimum.point, &mut [0.0; 3]), minimum.cost);
        assert!(descend(&Settings::paper(0.49, 2000)).cost < 1e-12, "just below");
    }

    #[test]
    fn the_bold_driver_survives_a_rate_that_diverges_and_never_climbs() {
        for first_rate in [1e-3, 100.0] {
            let bold = descend(&Settings::bold_driver(first_rate, 400));
            assert!(bold.history.windows(2).all(|pair| pair[1] <= pair[0]));
            assert!(bold.cost < 1e-8, "{} from {first_rate}", bold.cost);
        }
        let mut heavy = Settings::bold_driver(100.0, 9);
        heavy.momentum = 0.9;
        let costs = descend(&heavy).history;
        assert!(costs[8] == costs[0] && costs[9] < costs[0], "{costs:?}");
    }

    #[test]
    fn it_stops_at_the_target_cost() {
        let mut settings = Settings::paper(0.3, 1000);
        settings.target_cost = Some(0.01);
        let minimum = descend(&settings);
        assert_eq!(minimum.termination, Termination::TargetCost);
        assert!(minimum.cost <= 0.01 && minimum.history[minimum.iterations - 1] > 0.01);
    }

    #[test]
    fn it_stops_where_nothing_leads_on() {
        let nowhere = |_: &[f64], _: &mut [f64]| f64::NAN;
        for momentum in [0.0, 0.9] {
            let mut settings = Settings::paper(0.3, 1000);
            settings.momentum = momentum;
            let flat = minimise(quadratic, &[0.0; 3], &settings, go_on).unwrap();
            assert_eq!(flat.termination, Termination::Stalled);
            let undefined = minimise(nowhere, &START, &settings, go_on).unwrap();
            assert_eq!(undefined.termination, Termination::Diverged);
            assert_eq!(undefined.point, START);
        }
    }

    #[test]
    fn the_observer_stops_it() {
        let stop_at_7 = |iteration, _| match iteration {
            7 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let minimum = minimise(quadratic, &START, &Settings::paper(0.1, 9), stop_at_7).unwrap();
        assert_eq!(minimum.termination, Termination::Cancelled);
        assert_eq!((minimum.iterations, minimum.history.len()), (7, 8));
    }

    #[test]
    fn settings_out_of_range_are_refused_by_name() {
        let with = |rate, momentum| Settings { rate, momentum, ..Settings::paper(0.1, 10) };
        let table = [
            ("rate", with(LearningRate::Fixed(0.0), 0.0)),
            ("rate", with(LearningRate::BoldDriver(f64::NAN), 0.0)),
            ("momentum", with(LearningRate::Fixed(0.1), 1.0)),
            ("momentum", with(LearningRate::Fixed(0.1), f64::NAN)),
        ];
        for (setting, settings) in table {
            let refused = minimise(quadratic, &START, &settings, go_on);
            assert_eq!(refused.unwrap_err().setting, setting);
        }
    }
}
