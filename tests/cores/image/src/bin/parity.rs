//! Everything that the instrument computes, as hashes: `parity 1048576` takes so many samples in all.
//!
//! Each line is a part with its samples, the outputs that were numbers, and the hash of all outputs. The last
//! line is the whole. Two machines that print the same lines gave the same bits.
#![cfg_attr(target_os = "none", no_std, no_main)]

use cores::Digest;
use cores::parity::{PARTS, parts};
use cores_image::platform::{number, say};

cores_image::program!(run);

fn run() {
    let each = number(1).unwrap_or(1 << 20).div_ceil(PARTS);
    let mut whole = Digest::default();
    parts(each, |name, part| match part {
        Some(part) => {
            whole.digest(&part);
            say!("{name}: {each} samples, {} numbers, {:016x}", part.numbers, part.hash());
        }
        None => say!("{name}: refused"),
    });
    say!("all: {} samples, {} numbers, {:016x}", each * PARTS, whole.numbers, whole.hash());
}
