//! Claim: what the instrument computes are the bits that it computed when they were recorded, on this machine too.
//!
//! `.ci/cores` holds the microcontrollers' cores against the host with the same program and a million samples.

use cores::parity::parts;
use std::fmt::Write;
use tests::golden;

/// Enough to reach every oddity in the stream of samples often.
const EACH: u32 = 1 << 14;

#[test]
fn every_part_has_the_recorded_bits() {
    let mut record = String::new();
    parts(EACH, |name, part| {
        let part = part.expect("every calibration is accepted");
        assert!(part.numbers > EACH / 2, "{name}: mostly no numbers, which would compare nothing");
        writeln!(record, "{:016x} {name}", part.hash()).expect("a string takes it");
    });
    golden::check("parity-v1.txt", record.as_bytes());
}
