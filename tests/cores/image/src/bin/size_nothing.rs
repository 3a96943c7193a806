//! What start-up, printing and arguments weigh, to be subtracted from the other two.
#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;
use cores_image::platform::{number, say};

cores_image::program!(run);

fn run() {
    say!("{:08x}", black_box(number(1).unwrap_or(0)));
}
