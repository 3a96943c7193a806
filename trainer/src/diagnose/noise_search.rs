//! Estimates the noise by maximum likelihood: pattern search over the logarithms of its parts.

use super::evidence::Bench;
use super::layout::Layout;
use super::whitening::{BEGINNING, Columns, NoiseModel, PARTS, TURN, WALK};

/// Parts below this share of the sample noise make no difference.
const LEAST: f64 = 0.02;
const MOST: f64 = 1e5;
/// A random walk is counted per √s; this many seconds make it comparable with the others.
const WALK_S: f64 = 3600.0;
/// Factors by which a part is changed.
const STEPS: [f64; 4] = [8.0, 3.0, 1.6, 1.2];
/// A gain in −2 log likelihood that is not worth another round.
const ENOUGH: f64 = 0.1;
/// How often instrument and noise are fitted in turn when nothing is known.
const TURNS: usize = 2;

/// The most likely noise of a residual, the instrument's freedom used to the full; from `start`, or from a first guess
/// when nothing is known.
pub(super) fn noise(
    layout: &Layout,
    residual: &Columns,
    freedom: &Columns,
    start: NoiseModel,
    coarse: bool,
) -> NoiseModel {
    let mut noise = start;
    for turn in 0..if coarse { TURNS } else { 1 } {
        let Some(bench) = Bench::new(layout, noise, residual, freedom) else { return noise };
        let adapted = bench.adapted(residual, freedom);
        noise = search(layout, &adapted, noise, if coarse && turn == 0 { 0 } else { 1 });
    }
    noise
}

fn search(layout: &Layout, residual: &Columns, start: NoiseModel, from: usize) -> NoiseModel {
    let deviance = |noise: &NoiseModel| noise.deviance(layout, residual);
    let remembers = |place: usize| layout.remembered.iter().any(|(other, _)| *other == place);
    let parts: Vec<usize> = (0..PARTS).filter(|&part| part < BEGINNING || remembers(part - BEGINNING)).collect();
    let mut best = (start, deviance(&start));
    for step in &STEPS[from..] {
        loop {
            let before = best.1;
            for part in &parts {
                best = improved(best, *part, *step, &deviance);
            }
            if before - best.1 < ENOUGH.max(*step) {
                break;
            }
        }
    }
    best.0
}

fn improved(
    best: (NoiseModel, f64),
    part: usize,
    step: f64,
    deviance: &impl Fn(&NoiseModel) -> f64,
) -> (NoiseModel, f64) {
    for factor in [step, step.recip()] {
        let mut found = best;
        while let Some(next) = changed(&found.0, part, factor) {
            let value = deviance(&next);
            if value >= found.1 {
                break;
            }
            found = (next, value);
        }
        if found.1 < best.1 {
            return found;
        }
    }
    best
}

/// `None` at a bound, and for a part that is nothing at all: that is how a part is left out.
fn changed(noise: &NoiseModel, part: usize, factor: f64) -> Option<NoiseModel> {
    if noise.parts[part] == 0.0 {
        return None;
    }
    let mut next = *noise;
    let unit = if part == WALK { noise.sample / WALK_S.sqrt() } else { noise.sample };
    next.parts[part] = (noise.parts[part] * factor).clamp(LEAST * unit, MOST * unit);
    (next.parts[part] != noise.parts[part]).then_some(next)
}

/// Where the search begins: every part about as large as the sample noise, none for what must prove itself (`TURN`).
pub(super) fn first_guess(sample: f64, per_c: f64) -> NoiseModel {
    let mut parts = [sample; PARTS];
    parts[WALK] = sample / WALK_S.sqrt() * 0.3;
    parts[TURN] = 0.0;
    NoiseModel { sample, per_c, parts }
}
