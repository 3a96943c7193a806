//! One piece of the instrument's work, over and over between two marks: `cost network 1000`.
//!
//! A plugin of the emulator counts what is executed from [`begin`] to [`end`]; `bench/cost/run` reads it.
#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;
use cores::calibrations::{bare, term, with};
use cores::{Samples, calibrations};
use cores_image::platform::{is, number, say};
use firmware_core::{Compensator, Network};
use protocol::limits::MAX_BLOB;
use protocol::{Blob, Reading, Sample};

cores_image::program!(run);

fn run() {
    let count = number(2).unwrap_or(1000);
    if is(1, "nothing") {
        (0..count).for_each(|_| measured(|| {}));
    } else if is(1, "network") {
        network(count);
    } else if is(1, "no-effect") {
        compensation(&bare(), count);
    } else if is(1, "thermal-lag") {
        compensation(&with([term(1, 0, &[35.0], &[])].into_iter().collect()), count);
    } else if is(1, "eight-effects") {
        compensation(&calibrations::ALL[1].1(), count);
    } else if is(1, "six-programs") {
        compensation(&calibrations::ALL[4].1(), count);
    } else if is(1, "load") {
        loading(count);
    } else {
        say!("no such case");
    }
}

/// The network alone, over the calibrated domain.
fn network(count: u32) {
    let network = Network::<f32>::new(&bare().weights);
    for n in 0..count {
        let [x, t] = black_box([(n % 32) as f32 / 16.0 - 1.0, (n / 32 % 32) as f32 / 16.0 - 1.0]);
        measured(|| evaluate(&network, x, t));
    }
}

#[inline(never)]
fn evaluate(network: &Network<f32>, x: f32, t: f32) -> f32 {
    network.evaluate(x, t)
}

/// From a sample to its reading.
fn compensation(blob: &Blob, count: u32) {
    let Ok(mut compensator) = Compensator::load(blob) else { return say!("refused") };
    for (_, sample) in (0..count).zip(Samples::ordinary()) {
        measured(|| compensate(&mut compensator, black_box(&sample)));
    }
}

#[inline(never)]
fn compensate(compensator: &mut Compensator, sample: &Sample) -> Reading {
    compensator.compensate(sample)
}

/// From a stored calibration with eight effects to a compensator, its proof included.
fn loading(count: u32) {
    let mut buffer = [0; MAX_BLOB];
    let Ok(bytes) = calibrations::ALL[1].1().to_bytes(&mut buffer) else { return say!("too large") };
    (0..count).for_each(|_| measured(|| load(black_box(bytes))));
}

#[inline(never)]
fn load(bytes: &[u8]) -> Option<Compensator> {
    Compensator::load(&Blob::from_bytes(bytes).ok()?).ok()
}

fn measured<T>(work: impl FnOnce() -> T) {
    begin();
    black_box(work());
    end();
}

/// Where counting starts. Its store marks where the stack stood.
#[inline(never)]
fn begin() {
    let place = 1_u32;
    black_box(&place);
}

/// Where counting ends.
#[inline(never)]
fn end() {
    black_box(2_u32);
}
