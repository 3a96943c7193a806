//! Campaigns with known answers, from formulas instead of a simulator: the trainer must not see one.

use protocol::Sample;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;
use std::path::PathBuf;
use trainer::campaign::{Campaign, Quantity, Row, Run};
use trainer::fit::random::{between, stream, unit};

/// White noise of one sample, g.
pub const NOISE_G: f64 = 5e-6;

const SEED: u64 = 20_260_711;
const HZ_PER_G: f64 = 80.0;
/// Degrees from the middle of the range to either end.
const HALF_SPAN_C: f64 = 60.0;
const MIDDLE_C: f64 = 25.0;
/// A soaked state is sampled so often.
const SAMPLES_PER_STATE: usize = 30;
/// Accelerations of the states at one temperature, g.
const LEVELS_G: [f64; 6] = [-1.0, -0.6, -0.2, 0.2, 0.6, 1.0];

/// Inputs scattered evenly over the unit square, and a map with every term that a network finds hard:
/// curved, saturating and periodic in temperature. No two neighbours share a state.
pub fn scattered(samples: usize) -> Campaign {
    let mut random = stream(SEED, 0);
    let rows = (0..samples).map(|second| {
        let [x, t] = [0; 2].map(|_| between(&mut random, -1.0, 1.0));
        let bilinear = 0.9 * x + 0.05 * t + 0.02 * x * t;
        let departure = 0.03 * t * t + 0.005 * (3.0 * t).tanh() * x + 0.002 * (4.0 * t).sin();
        let reference_g = bilinear + departure + NOISE_G * normal(&mut random);
        row(second, HZ_PER_G * x, MIDDLE_C + HALF_SPAN_C * t, reference_g)
    });
    campaign(vec![run(0, rows.collect())])
}

/// Three runs of soaked states: temperatures from one end of the range to the other, six positions each.
pub fn soaked(samples: usize) -> Campaign {
    let states = samples / 3 / SAMPLES_PER_STATE;
    let nodes = states.div_ceil(LEVELS_G.len());
    let state = |run: usize, state: usize| {
        let mut random = stream(SEED, (1 + run * states + state) as u64);
        let part = (state / LEVELS_G.len()) as f64 / (nodes.max(2) - 1) as f64;
        let temperature_c = MIDDLE_C + HALF_SPAN_C * (2.0 * part - 1.0) + between(&mut random, -0.3, 0.3);
        let reference_g = LEVELS_G[state % LEVELS_G.len()];
        let noise = |random: &mut Xoshiro256PlusPlus| HZ_PER_G * NOISE_G * normal(random);
        (0..SAMPLES_PER_STATE)
            .map(|sample| {
                let delta_f_hz = resonators_hz(reference_g, temperature_c) + noise(&mut random);
                row(state * SAMPLES_PER_STATE + sample, delta_f_hz, temperature_c, reference_g)
            })
            .collect::<Vec<_>>()
    };
    campaign((0..3).map(|k| run(k, (0..states).flat_map(|s| state(k, s)).collect())).collect())
}

/// Difference of two resonators, one pulled and one pushed by the proof mass, f = f₀·√(1 ± k·a).
fn resonators_hz(reference_g: f64, temperature_c: f64) -> f64 {
    let warmer_c = temperature_c - MIDDLE_C;
    let per_g = 1.95e-3 * (1.0 + 60e-6 * warmer_c + 0.2e-6 * warmer_c * warmer_c);
    let pulled_hz = 41_238.0 * (1.0 - 30.0e-6 * warmer_c - 40e-9 * warmer_c.powi(2));
    let pushed_hz = 41_162.0 * (1.0 - 29.3e-6 * warmer_c - 41e-9 * warmer_c.powi(2) + 10e-12 * warmer_c.powi(3));
    pulled_hz * (1.0 + per_g * reference_g).sqrt() - pushed_hz * (1.0 - 0.99 * per_g * reference_g).sqrt()
}

fn campaign(runs: Vec<Run>) -> Campaign {
    Campaign::new(runs, Vec::new(), Quantity::default())
}

fn run(index: usize, rows: Vec<Row>) -> Run {
    Run { name: format!("full-{index}"), kind: "full".to_owned(), source: PathBuf::new(), rows }
}

fn row(second: usize, delta_f_hz: f64, temperature_c: f64, reference_g: f64) -> Row {
    let micro = |value: f64| (value * 1e6).round();
    let sample =
        Sample::from_difference(second as u64 * 1_000_000, micro(delta_f_hz) as i64, micro(temperature_c) as i32);
    Row { sample, reference_g, reference_sigma_g: None }
}

/// Standard normal, after Box and Muller.
fn normal(random: &mut Xoshiro256PlusPlus) -> f64 {
    let (radius, angle) = (1.0 - unit(random), unit(random));
    (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
}
