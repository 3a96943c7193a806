//! What the network and the reader of stored calibrations weigh: from bytes to an output.
#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;
use cores_image::platform::{number, say};
use firmware_core::Network;
use protocol::Blob;

cores_image::program!(run);

fn run() {
    let [x, t] = black_box([0.5_f32, -0.25]);
    let output = Blob::from_bytes(black_box(&[])).map_or(0.0, |blob| Network::new(&blob.weights).evaluate(x, t));
    say!("{:08x}", black_box(number(1).unwrap_or(0)) ^ output.to_bits());
}
