//! Claim: the image that runs on the microcontroller gives the host's bits.
//!
//! QEMU's netduinoplus2 is an STM32F405 without the sensors, so samples are replayed and live
//! measuring must end in flags.

use firmware_core::Compensator;
use firmware_sim::link::Link;
use firmware_sim::virtual_faulty_line::{FaultyLine, LineFaults};
use protocol::{Blob, Reading, Sample, Status};
use std::time::Duration;
use tests::example;
use tests::qemu::Microcontroller;

/// On a busy machine an answer may take seconds; a broken image takes for ever.
const PATIENCE: Duration = Duration::from_secs(10);

fn started(identity: &[u8], calibration: &[u8]) -> Link<Microcontroller> {
    Link::new(Microcontroller::start(identity, calibration, PATIENCE))
}

fn on_the_host(samples: &[Sample]) -> Vec<Reading> {
    on_the_host_with(&example::blob(), samples)
}

fn on_the_host_with(blob: &Blob, samples: &[Sample]) -> Vec<Reading> {
    let mut compensator = Compensator::load(blob).expect("the example is sound");
    samples.iter().map(|sample| compensator.compensate(sample)).collect()
}

#[test]
fn the_microcontroller_gives_the_hosts_bits() {
    let samples = example::samples(2500);
    let mut link = started(example::SERIAL.as_bytes(), &[]);
    link.upload_blob(&example::blob()).expect("the example is sound");
    for (sample, expected) in samples.iter().zip(on_the_host(&samples)) {
        let found = link.replay(sample).expect("an answer");
        assert!(found.same_bits(&expected), "{sample:?}\nexpected {expected:?}\nfound    {found:?}");
    }
}

#[test]
fn the_microcontroller_gives_the_hosts_bits_of_a_users_own_expression() {
    let (blob, samples) = (example::with_expression(), example::samples(500));
    let mut link = started(example::SERIAL.as_bytes(), &[]);
    link.upload_blob(&blob).expect("the example is sound");
    for (sample, expected) in samples.iter().zip(on_the_host_with(&blob, &samples)) {
        let found = link.replay(sample).expect("an answer");
        assert!(found.same_bits(&expected), "{sample:?}\nexpected {expected:?}\nfound    {found:?}");
    }
}

#[test]
fn the_stored_calibration_is_in_use_from_the_start() {
    let mut link = started(example::SERIAL.as_bytes(), &example::blob_bytes());
    assert_eq!(link.identify().expect("an answer").serial, example::SERIAL);
    assert_eq!(link.state().expect("an answer").provenance, Some(example::blob().provenance));
    let samples = example::samples(50);
    for (sample, expected) in samples.iter().zip(on_the_host(&samples)) {
        assert!(link.replay(sample).expect("an answer").same_bits(&expected));
    }
}

#[test]
fn a_spoilt_or_foreign_stored_calibration_leaves_it_uncalibrated_and_talking() {
    let mut spoilt = example::blob_bytes();
    spoilt[100] ^= 1;
    for (identity, calibration) in [(example::SERIAL, spoilt), ("ANOTHER", example::blob_bytes())] {
        let mut link = started(identity.as_bytes(), &calibration);
        assert_eq!(link.state().expect("an answer").provenance, None);
        let reading = link.replay(&example::samples(1)[0]).expect("an answer");
        assert_eq!(reading.status, Status::UNCALIBRATED);
    }
}

#[test]
fn without_sensors_it_measures_flags_and_never_hangs() {
    let mut link = started(example::SERIAL.as_bytes(), &example::blob_bytes());
    let mut last_us = 0;
    for _ in 0..20 {
        let (sample, reading) = link.measure().expect("an answer");
        assert!(sample.faults.contains(Status::THERMOMETER_FAULT | Status::RESONATOR_FAULT), "{sample:?}");
        assert_eq!(reading.acceleration_g.to_bits(), Reading::NO_NUMBER.to_bits());
        assert!(sample.time_us > last_us, "time runs forward");
        last_us = sample.time_us;
    }
}

/// Of the 128 KiB that there are; `docs/cost.md` has what is used.
const STACK_BUDGET: usize = 24 * 1024;

#[test]
fn the_stack_stays_within_its_budget() {
    let (microcontroller, mut stack) =
        Microcontroller::start_painted(example::SERIAL.as_bytes(), &example::blob_bytes(), PATIENCE);
    let mut link = Link::new(microcontroller);
    // The deepest paths: a calibration taken over while another is in use, and readings with every kind of memory.
    link.upload_blob(&example::with_expression()).expect("the example is sound");
    for sample in &example::samples(200) {
        link.replay(sample).expect("an answer");
    }
    link.measure().expect("an answer");
    let depth = stack.depth();
    println!("stack: {depth} bytes");
    assert!((1024..=STACK_BUDGET).contains(&depth), "{depth} bytes of stack, {STACK_BUDGET} are allowed");
}

#[test]
fn a_bad_line_to_the_microcontroller_changes_no_bit() {
    let faults = LineFaults { flip_ppm: 300, loss_ppm: 300, duplication_ppm: 300 };
    let microcontroller = Microcontroller::start(example::SERIAL.as_bytes(), &[], Duration::from_millis(100));
    let mut link = Link::new(FaultyLine::new(microcontroller, faults, 1)).with_tries(100);
    link.upload_blob(&example::blob()).expect("repetition gets it through");
    let samples = example::samples(300);
    for (sample, expected) in samples.iter().zip(on_the_host(&samples)) {
        assert!(link.replay(sample).expect("repetition gets it through").same_bits(&expected), "{sample:?}");
    }
}
