//! What the whole compensation weighs, every effect included: from bytes and a sample to a reading.
#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;
use cores_image::platform::{number, say};
use firmware_core::Compensator;
use protocol::{Blob, Sample};

cores_image::program!(run);

fn run() {
    let sample = black_box(Sample::from_difference(0, 1, 2));
    let compensator = Blob::from_bytes(black_box(&[])).ok().and_then(|blob| Compensator::load(&blob).ok());
    let output = compensator.map_or(0.0, |mut compensator| compensator.compensate(&sample).acceleration_g);
    say!("{:08x}", black_box(number(1).unwrap_or(0)) ^ output.to_bits());
}
