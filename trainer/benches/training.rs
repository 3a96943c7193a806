//! What a training costs: `cargo bench -p trainer`.

#[path = "../examples/shared/separable.rs"]
mod separable;
#[path = "shared/synthetic.rs"]
mod synthetic;

use divan::{Bencher, black_box};
use protocol::limits::WEIGHTS;
use separable::{Departure, random_start};
use std::ops::ControlFlow;
use trainer::campaign::{Campaign, HoldOut};
use trainer::fit::firefly::{Domain, ImprovedSettings, StandardSettings, improved, standard};
use trainer::fit::levenberg_marquardt::{Problem, Quadratic};
use trainer::fit::random::stream;
use trainer::progress::Quiet;
use trainer::train::{Backprop, Method, TrainSettings, train};

fn main() {
    divan::main();
}

/// The whole training with 30 restarts and everything that belongs to it.
#[divan::bench(args = [2_160, 20_000], sample_count = 5, sample_size = 1)]
fn thirty_restarts_on_soaked_states(bencher: Bencher, samples: usize) {
    let campaign = synthetic::soaked(samples);
    bencher.bench(|| trained(&campaign, Method::SecondOrder, 30));
}

/// No two samples can be merged into one mean here.
#[divan::bench(args = [2_160, 20_000], sample_count = 3, sample_size = 1)]
fn thirty_restarts_on_scattered_samples(bencher: Bencher, samples: usize) {
    let campaign = synthetic::scattered(samples);
    bencher.bench(|| trained(&campaign, Method::SecondOrder, 30));
}

/// The paper's trainings; each restart is a swarm and a descent.
#[divan::bench(args = ["fa-bp", "ifa-bp"], sample_count = 3, sample_size = 1)]
fn thirty_restarts_from_fireflies_on_2160_soaked_samples(bencher: Bencher, name: &str) {
    let campaign = synthetic::soaked(2_160);
    let backprop = if name == "fa-bp" { Backprop::standard() } else { Backprop::improved() };
    bencher.bench(|| trained(&campaign, Method::Backprop(backprop.clone()), 30));
}

/// The swarm's own share: ten fireflies, fifty generations, 41 weights, an objective that costs nothing.
#[divan::bench(args = ["standard", "improved"])]
fn fireflies_alone(bencher: Bencher, name: &str) {
    let domain = Domain::cube(WEIGHTS, &(-1.0..=1.0)).expect("bounds in order");
    let sphere = |weights: &[f64]| weights.iter().map(|weight| weight * weight).sum();
    let go_on = |_: usize, _: &_| ControlFlow::Continue(());
    bencher.bench(|| match name {
        "standard" => standard(sphere, &domain, &StandardSettings::recommended(), &mut stream(1, 0), go_on),
        _ => improved(sphere, &domain, &ImprovedSettings::recommended(), &mut stream(1, 0), go_on),
    });
}

/// One pass over the rows for the cost.
#[divan::bench]
fn cost_of_2160_rows(bencher: Bencher) {
    let departure = Departure::of(&synthetic::scattered(2_160));
    let (mut problem, start) = (departure.problem(), random_start(&mut stream(1, 0)));
    bencher.bench_local(|| problem.cost(black_box(&start)));
}

/// Cost, gradient and Gauss–Newton matrix: what an accepted step costs.
#[divan::bench]
fn linearisation_of_2160_rows(bencher: Bencher) {
    let departure = Departure::of(&synthetic::scattered(2_160));
    let (mut problem, start) = (departure.problem(), random_start(&mut stream(1, 0)));
    let mut quadratic = Quadratic::zeros(start.len());
    bencher.bench_local(|| problem.linearise(black_box(&start), &mut quadratic));
}

fn trained(campaign: &Campaign, method: Method, restarts: usize) -> f64 {
    let split = campaign.split(&HoldOut::None).expect("runs to train on");
    let settings = TrainSettings { method, restarts, ..TrainSettings::new(1) };
    let trained = train(campaign, &split, &settings, &Quiet).expect("a model");
    trained.model.provenance.training_residual
}
