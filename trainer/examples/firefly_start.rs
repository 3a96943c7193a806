//! Is a firefly swarm of any use as a start for second-order training?
//!
//! Every way of finding first weights gets the same number of evaluations, its own included, and
//! spends them start after start. `cargo run --release -p trainer --example firefly_start` prints
//! the table; it is the same on every run.

#[path = "shared/separable.rs"]
mod separable;
#[path = "../benches/shared/synthetic.rs"]
mod synthetic;

use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use separable::{Departure, STEEPEST_START, random_start};
use std::ops::ControlFlow;
use synthetic::NOISE_G;
use trainer::fit::firefly::{Domain, ImprovedSettings, StandardSettings, improved, standard};
use trainer::fit::levenberg_marquardt::{CAUTIOUS, Limits, Problem, Quadratic, minimise};
use trainer::fit::network::NONLINEAR;
use trainer::fit::random::stream;

/// Independent repetitions, each with its own seed.
const REPETITIONS: u64 = 24;
/// Evaluations after which the best residual is noted.
const BUDGETS: [usize; 3] = [2_000, 6_000, 20_000];
/// Gradient and Gauss–Newton matrix in terms of evaluations of the cost; the bench measures both.
const LINEARISATION: usize = 9;
/// A network has reached the noise when its residual is within five per cent of it.
const REACHED: f64 = 1.05;
/// As the trainer's.
const LIMITS: Limits = Limits { iterations: 200, decrease: 1e-5, step: 1e-9, damping: CAUTIOUS };
/// What a swarm of ten costs in fifty generations, as nearly as comparing takes.
const SWARM_EVALUATIONS: usize = 560;

/// How first weights are found.
#[derive(Clone, Copy)]
enum Start {
    Random,
    BestOfRandom,
    StandardSwarm,
    ImprovedSwarm,
    PrintedSwarm,
}

impl Start {
    const ALL: [(Self, &str); 5] = [
        (Self::Random, "random"),
        (Self::BestOfRandom, "best of 560 random"),
        (Self::StandardSwarm, "standard firefly"),
        (Self::ImprovedSwarm, "improved firefly"),
        (Self::PrintedSwarm, "improved, as printed"),
    ];

    fn find(self, problem: &mut impl Problem, random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
        let domain = Domain::cube(NONLINEAR, &(-STEEPEST_START..=STEEPEST_START)).expect("bounds in order");
        let cost = |point: &[f64]| problem.cost(point);
        let go_on = |_: usize, _: &_| ControlFlow::Continue(());
        let swarm = match self {
            Self::Random => return random_start(random),
            Self::BestOfRandom => return best_of_random(problem, random),
            Self::StandardSwarm => standard(cost, &domain, &StandardSettings::recommended(), random, go_on),
            Self::ImprovedSwarm => improved(cost, &domain, &ImprovedSettings::recommended(), random, go_on),
            Self::PrintedSwarm => improved(cost, &domain, &ImprovedSettings::paper(), random, go_on),
        };
        swarm.expect("settings that make sense").best
    }
}

fn best_of_random(problem: &mut impl Problem, random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let starts = (0..SWARM_EVALUATIONS).map(|_| random_start(random));
    let costs = starts.map(|start| (problem.cost(&start), start));
    costs.min_by(|a, b| a.0.total_cmp(&b.0)).expect("at least one start").1
}

/// Counts what a problem is asked, and notes the least cost within each budget.
struct Metered<P> {
    problem: P,
    spent: usize,
    least: [f64; BUDGETS.len()],
    /// The cost of a network that has reached the noise, and when there was one.
    target: f64,
    reached: Option<usize>,
}

impl<P> Metered<P> {
    fn note(&mut self, cost: f64, evaluations: usize) {
        self.spent += evaluations;
        if self.reached.is_none() && cost <= self.target {
            self.reached = Some(self.spent);
        }
        for (least, budget) in self.least.iter_mut().zip(BUDGETS) {
            if self.spent <= budget && cost < *least {
                *least = cost;
            }
        }
    }

    fn spent_all(&self) -> bool {
        self.spent >= BUDGETS[BUDGETS.len() - 1]
    }
}

impl<P: Problem> Problem for Metered<P> {
    fn parameters(&self) -> usize {
        self.problem.parameters()
    }

    fn cost(&mut self, point: &[f64]) -> f64 {
        let cost = self.problem.cost(point);
        self.note(cost, 1);
        cost
    }

    fn linearise(&mut self, point: &[f64], quadratic: &mut Quadratic) {
        self.problem.linearise(point, quadratic);
        self.note(quadratic.cost, LINEARISATION);
    }
}

/// One repetition.
struct Repetition {
    /// Least residual within each budget, g.
    least_g: [f64; BUDGETS.len()],
    /// What every completed start ended with, g.
    finals_g: Vec<f64>,
    /// Evaluations until the noise was reached; infinite if it was not.
    reached: f64,
}

fn repeat(departure: &Departure, noise_g: f64, start: Start, seed: u64) -> Repetition {
    let mut problem = Metered {
        problem: departure.problem(),
        spent: 0,
        least: [f64::INFINITY; BUDGETS.len()],
        target: departure.cost(REACHED * noise_g),
        reached: None,
    };
    let mut finals_g = Vec::new();
    for index in 0.. {
        let first = start.find(&mut problem, &mut stream(seed, index));
        let minimum = minimise(&mut problem, &first, &LIMITS, |_, _| ControlFlow::Continue(()));
        if problem.spent_all() {
            break;
        }
        finals_g.push(departure.residual_g(minimum.cost));
    }
    let reached = problem.reached.map_or(f64::INFINITY, |evaluations| evaluations as f64);
    Repetition { least_g: problem.least.map(|cost| departure.residual_g(cost)), finals_g, reached }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn line(departure: &Departure, noise_g: f64, start: Start, name: &str) {
    let repeat = |seed| repeat(departure, noise_g, start, seed);
    let repetitions: Vec<Repetition> = (0..REPETITIONS).into_par_iter().map(repeat).collect();
    let finals_g = || repetitions.iter().flat_map(|repetition| &repetition.finals_g).copied();
    let starts = finals_g().count() as f64 / REPETITIONS as f64;
    let one_ug = median(finals_g()) * 1e6;
    let least_ug = |budget: usize| median(repetitions.iter().map(|repetition| repetition.least_g[budget])) * 1e6;
    let least = [0, 1, 2].map(|budget| format!("{:>10.3}", least_ug(budget))).concat();
    let reached = median(repetitions.iter().map(|repetition| repetition.reached));
    println!("{name:22}{reached:>10.0}{least}{starts:>10.1}{one_ug:>10.3}");
}

fn main() {
    // Soaked states are merged into their means, which scatter by the square root of thirty less.
    let soaked_noise_g = NOISE_G / 30.0_f64.sqrt();
    for (what, campaign, noise_g) in [
        ("720 scattered samples", synthetic::scattered(720), NOISE_G),
        ("72 soaked states of 30 samples", synthetic::soaked(2_160), soaked_noise_g),
    ] {
        println!("{what}, noise {:.3} µg; medians of {REPETITIONS} repetitions", noise_g * 1e6);
        let budgets = BUDGETS.map(|budget| format!("{budget:>10}")).concat();
        println!("{:22}{:>10}{:^30}{:>20}", "", "until", "best µg in so many evaluations", "starts   one, µg");
        println!("{:22}{:>10}{budgets}", "start", "noise");
        let departure = Departure::of(&campaign);
        for (start, name) in Start::ALL {
            line(&departure, noise_g, start, name);
        }
        println!();
    }
}
