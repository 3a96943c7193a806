//! Claim: the image that runs on the microcontroller gives the host's bits.
//!
//! QEMU's netduinoplus2 is an STM32F405 without the sensors, so samples are replayed and live
//! measuring must end in flags.

use ed25519_compact::{KeyPair, Seed};
use firmware_core::{Compensator, FactoryKey, IdentityRecord};
use firmware_sim::link::{Content, Kept, Link, LinkError};
use firmware_sim::virtual_faulty_line::{FaultyLine, LineFaults};
use protocol::{Blob, Reading, Refusal, Sample, Signed, Source, Status, Streamed};
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
const STACK_BUDGET: usize = 32 * 1024;

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
fn where_the_flash_is_a_rom_it_says_so_and_runs_from_ram() {
    let mut link = started(example::SERIAL.as_bytes(), &example::blob_bytes());
    assert_eq!(link.storage().expect("an answer").source, Source::Factory);
    let other = Blob { provenance: *b"exampl-2", ..example::blob() };
    assert_eq!(link.upload_blob(&other).expect("the example is sound"), Kept::UntilPowerOff);
    assert_eq!(link.storage().expect("an answer").source, Source::UntilPowerOff);
    assert_eq!(link.read_calibration().expect("an answer"), example::stored(&other));
    link.roll_back().expect("to the stored one");
    assert_eq!(link.read_calibration().expect("an answer"), example::blob_bytes());
    assert!(matches!(link.roll_back(), Err(LinkError::Refused(Refusal::NothingBefore))));
}

#[test]
fn it_streams_at_its_own_pace_until_it_is_stopped() {
    let mut link = started(example::SERIAL.as_bytes(), &example::blob_bytes());
    link.stream(Streamed::Samples, 200).expect("an answer");
    let mut last_us = None;
    for number in 0..5 {
        let message = link.next_unasked().expect("a line").expect("a message");
        assert_eq!(message.number, number);
        let Content::Sample(sample) = message.content else { panic!("{message:?}") };
        // Without sensors, each waits half a period for news of them, as it must.
        let passed_us = last_us.map(|last_us| sample.time_us - last_us);
        assert!(passed_us.is_none_or(|passed_us| passed_us >= 100_000), "{passed_us:?}");
        last_us = Some(sample.time_us);
    }
    link.stop().expect("an answer");
    assert_eq!(link.identify().expect("an answer").serial, example::SERIAL);
}

#[test]
fn with_the_factorys_key_each_image_takes_what_it_can_vouch_for() {
    let factory = KeyPair::from_seed(Seed::new([1; 32]));
    let key = FactoryKey::Asked(*factory.pk);
    let identity = IdentityRecord { key, ..IdentityRecord::new(example::SERIAL) }.to_bytes();
    let blob = example::blob_bytes();
    let signed = [&blob[..], &Signed::trailer(&factory.sk.sign(&blob, None))].concat();
    let unsigned = |result| matches!(result, Err(LinkError::Refused(Refusal::Unsigned)));
    let mut link = Link::new(Microcontroller::start_with_signatures(&identity, PATIENCE));
    assert!(unsigned(link.upload(&blob)));
    assert_eq!(link.upload(&signed).expect("signed"), Kept::UntilPowerOff);
    assert_eq!(link.read_calibration().expect("an answer"), signed);
    // The image that can't check signatures vouches for none.
    let mut link = started(&identity, &blob);
    assert_eq!(link.state().expect("an answer").provenance, None);
    assert!(unsigned(link.upload(&signed)));
}

#[test]
fn a_bad_line_to_the_microcontroller_changes_no_bit() {
    let faults = LineFaults::each(300);
    let microcontroller = Microcontroller::start(example::SERIAL.as_bytes(), &[], Duration::from_millis(100));
    let mut link = Link::new(FaultyLine::new(microcontroller, faults, 1)).with_tries(100);
    link.upload_blob(&example::blob()).expect("repetition gets it through");
    let samples = example::samples(300);
    for (sample, expected) in samples.iter().zip(on_the_host(&samples)) {
        assert!(link.replay(sample).expect("repetition gets it through").same_bits(&expected), "{sample:?}");
    }
}
