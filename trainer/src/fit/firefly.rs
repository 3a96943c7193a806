//! Firefly algorithms: the standard one and the improved one of Huang et al., Micromachines 2022, 13, 1054.
//!
//! Global searches over a box that need nothing but costs. The paper chooses a network's initial weights
//! with them. Separate from the trainer's own start values, because they are here to reproduce the paper
//! and to be compared with, on equal numbers of evaluations.
//!
//! # Readings
//!
//! The paper's equations leave places open. Each choice is a setting or stated where it is made; these are
//! the ones without which its behaviour is not defined. Where the paper gives no hint (order of the moves,
//! one pull after the other, q, ε) the reading is the one with which the success rates of an independent
//! implementation are met; the tests hold each rate to that over 800 seeds.
//!
//! | eq. | open | read as |
//! |---|---|---|
//! | (4) | unit of r | [`DistanceScale`] |
//! | (5) | order of the moves | from the previous generation's positions, all fireflies at once |
//! | (5) | several brighter fireflies | one pull after the other, each with its own α(ξ − ½) |
//! | (5) | the brightest | stays; in the improved algorithm it is perturbed instead, before the others move |
//! | (6) | recursion, k | [`StepDecay`], k = 1 |
//! | (8) | ε and its unit | [`Epsilon`]; 0.01 in units of the cost in `paper()` |
//! | (9) | ξ, s | one ξ and one width per dimension |
//! | (10) | fate of the best | replaced when eq. (7) accepts worse; `archive` keeps it for the result |
//! | §2.2.2 | "several individuals" | q = 3 of the others, drawn without replacement for each firefly |
//!
//! # What to expect
//!
//! [`ImprovedSettings::paper`] and [`StandardSettings::paper`] are for reproducing the paper. What it
//! shows of the improved algorithm is typical of small domains (|x| ≤ 1) and of no larger one. Among the 41 weights of a 2-10-1
//! network the printed improved algorithm is worse than as many random points: everybody is so far away that
//! nobody attracts anybody. [`ImprovedSettings::recommended`] gets the cost several times lower (measured
//! over 40 seeds by the tests). It is the unit of distance that makes the difference; the Metropolis
//! criterion makes none.
//!
//! # Not supported
//!
//! Continuing a cancelled search, unbounded domains, parallel evaluation (restarts are what is parallel).

mod annealing;
mod domain;
mod error;
mod flock;
#[cfg(test)]
mod rates;
mod settings;
#[cfg(test)]
mod tests;

pub use domain::Domain;
pub use error::FireflyError;
pub use settings::{
    Attraction, DistanceScale, Epsilon, ImprovedSettings, Perturbed, StandardSettings, StepDecay, StepScale,
};

use annealing::Annealing;
use flock::{Flock, Movement};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::ops::ControlFlow;

/// One point of an evolution curve (the paper's figures 3 and 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Generation {
    /// Lowest cost: ever seen with the archive, of this generation without.
    pub best: f64,
    /// Mean cost of the fireflies of this generation; infinite if one of them is.
    pub mean: f64,
}

/// Why the search ended. Neither is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// All generations were made.
    Completed,
    /// The observer asked to stop.
    Cancelled,
}

/// Where the search ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Swarm {
    /// The best position: ever seen with the archive, of the last generation without.
    pub best: Vec<f64>,
    /// The cost there; infinite if no position had a finite one.
    pub best_cost: f64,
    /// The initial swarm and every generation after it.
    pub history: Vec<Generation>,
    /// How often the objective was called.
    pub evaluations: usize,
    /// Why the search ended.
    pub termination: Termination,
}

/// Minimises `objective` with the standard firefly algorithm, eqs. (4) and (5).
///
/// `observe` sees the initial swarm as generation 0 and each generation after it; it may stop the search.
/// Where the objective is not a number it counts as infinite.
///
/// # Errors
/// [`FireflyError`] when a setting makes no sense.
pub fn standard(
    objective: impl FnMut(&[f64]) -> f64,
    domain: &Domain,
    settings: &StandardSettings,
    rng: &mut Xoshiro256PlusPlus,
    observe: impl FnMut(usize, &Generation) -> ControlFlow<()>,
) -> Result<Swarm, FireflyError> {
    settings.check()?;
    let mut flock = Flock::scatter(settings.population, domain, objective, rng);
    let movement = Movement {
        attraction: settings.attraction,
        step: flock::step(settings.alpha0, settings.step_scale, domain),
        selected: None,
        anchored: None,
        clamp: settings.clamp,
    };
    let mut log = Log::new(settings.archive, observe);
    let termination = log.run(&mut flock, settings.generations, |flock, _| {
        flock.advance(&movement);
    });
    Ok(log.finish(&flock, termination))
}

/// Minimises `objective` with the improved firefly algorithm, eqs. (4) to (11).
///
/// In each generation the best firefly is perturbed and the Metropolis criterion decides whether it stays
/// there; then every other one moves towards the brighter ones among a few that it draws at random. The
/// rest is as in [`standard`].
///
/// # Errors
/// [`FireflyError`] when a setting makes no sense.
pub fn improved(
    objective: impl FnMut(&[f64]) -> f64,
    domain: &Domain,
    settings: &ImprovedSettings,
    rng: &mut Xoshiro256PlusPlus,
    observe: impl FnMut(usize, &Generation) -> ControlFlow<()>,
) -> Result<Swarm, FireflyError> {
    settings.check()?;
    let mut flock = Flock::scatter(settings.population, domain, objective, rng);
    let annealing = Annealing::new(settings, flock.costs());
    let mut log = Log::new(settings.archive, observe);
    let termination = log.run(&mut flock, settings.generations, |flock, n| {
        let best = flock.brightest();
        annealing.perturb(flock, best, n);
        let factor = settings.decay.factor(settings.k, n, settings.generations);
        flock.advance(&Movement {
            attraction: settings.attraction,
            step: flock::step(settings.alpha0 * factor, settings.step_scale, domain),
            selected: Some(settings.selected),
            anchored: Some(best),
            clamp: true,
        });
    });
    Ok(log.finish(&flock, termination))
}

/// What both algorithms do around a generation: record, tell the observer, stop.
struct Log<O> {
    archive: bool,
    observe: O,
    history: Vec<Generation>,
}

impl<O: FnMut(usize, &Generation) -> ControlFlow<()>> Log<O> {
    fn new(archive: bool, observe: O) -> Self {
        Self { archive, observe, history: Vec::new() }
    }

    fn run<F: FnMut(&[f64]) -> f64>(
        &mut self,
        flock: &mut Flock<'_, F>,
        generations: usize,
        mut advance: impl FnMut(&mut Flock<'_, F>, usize),
    ) -> Termination {
        let mut flow = self.record(flock);
        for n in 0..generations {
            if flow.is_break() {
                return Termination::Cancelled;
            }
            advance(flock, n);
            flow = self.record(flock);
        }
        Termination::Completed
    }

    fn record<F: FnMut(&[f64]) -> f64>(&mut self, flock: &Flock<'_, F>) -> ControlFlow<()> {
        let generation = Generation { best: self.best(flock).cost, mean: flock.mean_cost() };
        self.history.push(generation);
        (self.observe)(self.history.len() - 1, &generation)
    }

    fn best<'f, F: FnMut(&[f64]) -> f64>(&self, flock: &'f Flock<'_, F>) -> &'f flock::Firefly {
        if self.archive { flock.best_seen() } else { &flock.fireflies()[flock.brightest()] }
    }

    fn finish<F: FnMut(&[f64]) -> f64>(self, flock: &Flock<'_, F>, termination: Termination) -> Swarm {
        let best = self.best(flock);
        Swarm {
            best: best.position.clone(),
            best_cost: best.cost,
            evaluations: flock.evaluations(),
            history: self.history,
            termination,
        }
    }
}
