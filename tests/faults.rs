//! Claim: every fault of sensors, clock and calibrations is a flag or a refusal; the instrument goes on measuring.

use firmware_core::{Compensator, FactoryKey, IdentityRecord};
use firmware_sim::link::{Kept, Link, LinkError};
use firmware_sim::virtual_fault::PartFault;
use firmware_sim::virtual_flash::VirtualFlash;
use firmware_sim::virtual_instrument::VirtualInstrument;
use firmware_sim::virtual_line::VirtualLine;
use protocol::{Blob, Reading, Refusal, Sample, Signed, Source, Status, crc32};
use tests::example;

const F1_HZ: f64 = 41_238.0;
const F2_HZ: f64 = 41_162.0;
const ROOM_C: f64 = 25.0;
const SECOND_US: u64 = 1_000_000;

fn calibrated() -> VirtualInstrument {
    let mut instrument = VirtualInstrument::new(example::SERIAL);
    instrument.upload(&example::blob()).expect("the example is sound");
    instrument
}

/// Lets one thing fail.
type Break = fn(&mut VirtualInstrument);

#[test]
fn every_sensor_fault_is_a_flag_and_never_a_number() {
    const THERMOMETER: Status = Status::THERMOMETER_FAULT;
    const RESONATOR: Status = Status::RESONATOR_FAULT;
    let table: [(&str, Break, Status); 16] = [
        ("no thermometer", |i| i.thermometer_mut().fault = PartFault::Absent, THERMOMETER),
        ("its bus fails at once", |i| i.thermometer_mut().fault = PartFault::BusFailsAfter(0), THERMOMETER),
        ("its bus fails in the middle", |i| i.thermometer_mut().fault = PartFault::BusFailsAfter(3), THERMOMETER),
        ("not converted yet", |i| i.thermometer_mut().force_register(0x8000), THERMOMETER | Status::STALE),
        ("too cold to be true", |i| i.thermometer_mut().force_register(0x8001), THERMOMETER),
        ("too hot to be true", |i| i.thermometer_mut().force_register(0x7FFF), THERMOMETER),
        ("no counter", |i| i.counter_mut().fault = PartFault::Absent, RESONATOR),
        ("its bus fails at once", |i| i.counter_mut().fault = PartFault::BusFailsAfter(0), RESONATOR),
        ("its bus fails at the last byte", |i| i.counter_mut().fault = PartFault::BusFailsAfter(18), RESONATOR),
        ("the same gate twice", |i| drop(i.measure()), RESONATOR | Status::STALE),
        ("gate open since power-on", |i| i.counter_mut().store(2, &[0, 0]), RESONATOR | Status::STALE),
        ("resonator 1 stands still", |i| i.counter_mut().finish_gate(0, 41_000_000_000), RESONATOR),
        ("resonator 2 stands still", |i| i.counter_mut().finish_gate(41_000_000_000, 0), RESONATOR),
        ("counter 1 overflows", |i| i.counter_mut().finish_gate(1, 41_000_000_000), RESONATOR),
        ("counter 2 overflows", |i| i.counter_mut().finish_gate(41_000_000_000, 1), RESONATOR),
        ("more cycles than ticks", |i| i.counter_mut().store(8, &[0, 0, 0, 0]), RESONATOR),
    ];
    for (what, fail, expected) in table {
        let mut instrument = calibrated();
        instrument.set(F1_HZ, F2_HZ, ROOM_C);
        fail(&mut instrument);
        let (sample, reading) = instrument.measure().expect("a perfect line");
        assert_eq!((sample.faults, reading.status), (expected, expected), "{what}");
        assert_eq!(reading.acceleration_g.to_bits(), Reading::NO_NUMBER.to_bits(), "{what}");
    }
}

#[test]
fn a_bus_that_fails_at_any_byte_is_a_fault_and_one_that_holds_is_not() {
    // Two registers of 1 + 1 + 2 bytes on I²C, addresses counted once; 1 + 18 on SPI.
    for bytes in 0..=25 {
        let mut instrument = calibrated();
        instrument.set(F1_HZ, F2_HZ, ROOM_C);
        instrument.thermometer_mut().fault = PartFault::BusFailsAfter(bytes);
        instrument.counter_mut().fault = PartFault::BusFailsAfter(bytes);
        let (sample, _) = instrument.measure().expect("a perfect line");
        assert_eq!(sample.faults.contains(Status::THERMOMETER_FAULT), bytes < 8, "after {bytes} bytes");
        assert_eq!(sample.faults.contains(Status::RESONATOR_FAULT), bytes < 19, "after {bytes} bytes");
    }
}

#[test]
fn measuring_goes_on_after_a_fault() {
    let mut instrument = calibrated();
    instrument.set(F1_HZ, F2_HZ, ROOM_C);
    instrument.counter_mut().fault = PartFault::Absent;
    assert!(instrument.measure().expect("a perfect line").1.status.contains(Status::RESONATOR_FAULT));
    instrument.counter_mut().fault = PartFault::None;
    let (_, reading) = instrument.measure().expect("a perfect line");
    assert!(reading.acceleration_g.is_finite() && !reading.status.intersects(Status::FATAL));
    let state = instrument.link_mut().state().expect("a perfect line");
    assert!(state.raised.contains(Status::RESONATOR_FAULT), "the flag stays on record");
}

#[test]
fn a_thermometer_that_hangs_is_found_out_although_it_answers() {
    let mut instrument = calibrated();
    instrument.set(F1_HZ, F2_HZ, ROOM_C);
    instrument.thermometer_mut().fault = PartFault::Stuck;
    for second in 0..10 {
        instrument.set_time_us(second * SECOND_US);
        instrument.set(F1_HZ, F2_HZ, ROOM_C + 10.0);
        let (sample, reading) = instrument.measure().expect("a perfect line");
        let stuck = Status::THERMOMETER_FAULT | Status::STALE;
        assert_eq!(sample.faults, if second > 5 { stuck } else { Status::empty() }, "after {second} s");
        assert_eq!(reading.acceleration_g.is_nan(), second > 5);
    }
    instrument.thermometer_mut().fault = PartFault::None;
    instrument.set(F1_HZ, F2_HZ, ROOM_C);
    let (sample, reading) = instrument.measure().expect("a perfect line");
    assert!(sample.faults.is_empty() && reading.acceleration_g.is_finite(), "it recovers");
}

#[test]
fn a_clock_that_jumps_is_a_flag_and_measuring_goes_on() {
    const PAST: u64 = 50 * SECOND_US;
    // What it says at the jump, and a second later: it waits a while for time to pass the last good moment, no longer.
    let table = [
        ("a second later", PAST + SECOND_US, Status::empty(), Status::empty()),
        ("the same moment", PAST, Status::TIME_REVERSED, Status::empty()),
        ("two seconds back", PAST - 2 * SECOND_US, Status::TIME_REVERSED, Status::TIME_REVERSED),
        ("back to power-on", 0, Status::TIME_REVERSED, Status::empty()),
        ("an hour ahead", PAST + 3600 * SECOND_US, Status::STALE, Status::empty()),
        ("the end of time", u64::MAX, Status::STALE, Status::TIME_REVERSED),
    ];
    for (what, jump_us, at_once, later) in table {
        let mut instrument = calibrated();
        let mut status_at = |time_us| {
            instrument.set(F1_HZ, F2_HZ, ROOM_C);
            instrument.set_time_us(time_us);
            let (_, reading) = instrument.measure().expect("a perfect line");
            assert!(reading.acceleration_g.is_finite(), "{what}: {reading:?}");
            reading.status.intersection(Status::STALE | Status::TIME_REVERSED)
        };
        let steady: Vec<Status> = (0..=50).map(|second| status_at(second * SECOND_US)).collect();
        assert!(steady.iter().all(Status::is_empty), "{what}: {steady:?}");
        assert_eq!(status_at(jump_us), at_once, "{what}");
        assert_eq!(status_at(jump_us.saturating_add(SECOND_US)), later, "{what}, and on");
    }
}

#[test]
fn saturated_inputs_are_outside_and_never_a_wrong_number_within() {
    let within = Status::FREQUENCY_OUTSIDE | Status::TEMPERATURE_OUTSIDE;
    let table: [(&str, f64, f64, f64, Status); 6] = [
        ("pressed to the stop", 49_000.0, 34_000.0, ROOM_C, Status::FREQUENCY_OUTSIDE),
        ("pressed to the other stop", 34_000.0, 49_000.0, ROOM_C, Status::FREQUENCY_OUTSIDE),
        ("as fast as can be counted", 99_999_999.0, 1.0, ROOM_C, Status::FREQUENCY_OUTSIDE),
        ("as hot as can be told", F1_HZ, F2_HZ, 155.0, Status::TEMPERATURE_OUTSIDE),
        ("as cold as can be told", F1_HZ, F2_HZ, -60.0, Status::TEMPERATURE_OUTSIDE),
        ("in order", F1_HZ, F2_HZ, ROOM_C, Status::empty()),
    ];
    for (what, f1_hz, f2_hz, temperature_c, expected) in table {
        let mut instrument = calibrated();
        instrument.set(f1_hz, f2_hz, temperature_c);
        let (sample, reading) = instrument.measure().expect("a perfect line");
        assert!(sample.faults.is_empty() && reading.acceleration_g.is_finite(), "{what}: {reading:?}");
        assert_eq!(reading.status.intersection(within), expected, "{what}");
    }
}

/// The example's bytes, changed and closed with a right checksum again.
fn changed(change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = example::blob_bytes();
    bytes.truncate(bytes.len() - 4);
    change(&mut bytes);
    let checksum = crc32(&bytes);
    [&bytes[..], &checksum.to_le_bytes()].concat()
}

#[test]
fn calibrations_that_are_not_for_it_are_refused_and_the_one_in_use_runs_on() {
    let foreign = Blob { serial: "OTHER-9".try_into().expect("short"), ..example::blob() };
    let unknown = {
        let mut blob = example::blob();
        blob.terms[0].effect = 999;
        blob
    };
    let mut spoilt = example::blob_bytes();
    spoilt[99] ^= 4;
    let table = [
        ("of another sensor", example::stored(&foreign), Refusal::OtherSerial),
        ("of a newer layout", changed(|bytes| bytes[4] = 3), Refusal::Layout(3)),
        ("of an unreleased layout", changed(|bytes| bytes[4] = 1), Refusal::Layout(1)),
        ("with an effect from the future", example::stored(&unknown), Refusal::Unusable),
        ("with a flipped bit", spoilt, Refusal::Checksum),
        ("cut short", example::blob_bytes()[..100].to_vec(), Refusal::Truncated),
        ("something else", vec![0x55; 100], Refusal::NotABlob),
    ];
    for (what, bytes, refusal) in table {
        let mut instrument = calibrated();
        assert_eq!(instrument.link_mut().upload(&bytes), Err(LinkError::Refused(refusal)), "{what}");
        let state = instrument.link_mut().storage().expect("a perfect line");
        assert_eq!((state.source, state.sequence, state.erases), (Source::Committed, 1, [0, 1]), "{what}");
        assert_eq!(instrument.link_mut().read_calibration(), Ok(example::blob_bytes()), "{what}");
        instrument.set(F1_HZ, F2_HZ, ROOM_C);
        assert!(instrument.measure().expect("a perfect line").1.acceleration_g.is_finite(), "{what}");
    }
}

#[test]
fn a_foreign_or_newer_calibration_in_flash_leaves_the_one_before_in_use() {
    // The firmware or the serial number changed after the last commit.
    let mut link = Link::new(VirtualLine::new(example::SERIAL));
    link.upload_blob(&example::blob()).expect("a perfect line");
    let general = Blob { serial: "".try_into().expect("short"), provenance: *b"for any ", ..example::blob() };
    link.upload_blob(&general).expect("a perfect line");
    link.upload_blob(&example::blob()).expect("a perfect line");
    let flash = link.transport_mut().flash_mut().clone();
    let mut link = Link::new(VirtualLine::with(IdentityRecord::new("RENAMED-2"), flash));
    assert_eq!(link.state().expect("a perfect line").provenance, Some(*b"for any "));
    assert_eq!(link.storage().expect("a perfect line").sequence, 2);
}

mod signed {
    use super::*;
    use ed25519_compact::{KeyPair, Seed};

    fn keys(seed: u8) -> KeyPair {
        KeyPair::from_seed(Seed::new([seed; 32]))
    }

    fn signed_by(keys: &KeyPair, blob: &Blob) -> Vec<u8> {
        let bytes = example::stored(blob);
        let signature = keys.sk.sign(&bytes, None);
        [&bytes[..], &Signed::trailer(&signature)].concat()
    }

    fn asking(key: FactoryKey) -> Link<VirtualLine> {
        let identity = IdentityRecord { key, ..IdentityRecord::new(example::SERIAL) };
        Link::new(VirtualLine::with(identity, VirtualFlash::new()))
    }

    #[test]
    fn an_instrument_that_holds_a_key_takes_what_its_owner_signed_and_nothing_else() {
        let factory = keys(1);
        let mut link = asking(FactoryKey::Asked(*factory.pk));
        let signed = signed_by(&factory, &example::blob());
        let unsigned = Err(LinkError::Refused(Refusal::Unsigned));
        assert_eq!(link.upload_blob(&example::blob()), unsigned);
        assert_eq!(link.upload(&signed_by(&keys(2), &example::blob())), unsigned, "another one's");
        let other = Blob { provenance: *b"exampl-2", ..example::blob() };
        let tail = signed[signed.len() - 68..].to_vec();
        assert_eq!(link.upload(&[example::stored(&other), tail].concat()), unsigned, "of another calibration");
        for bit in (0..64 * 8).step_by(7) {
            let mut spoilt = signed.clone();
            let at = signed.len() - 64 + bit / 8;
            spoilt[at] ^= 1 << (bit % 8);
            assert_eq!(link.upload(&spoilt), unsigned, "bit {bit} of the signature");
        }
        assert_eq!(link.upload(&signed), Ok(Kept::ForGood));
        link.transport_mut().power_cycle();
        link.begin();
        assert_eq!(link.read_calibration(), Ok(signed));
    }

    #[test]
    fn a_programmers_unsigned_calibration_is_no_way_around_and_a_spoilt_key_opens_nothing() {
        let flash = VirtualFlash::holding(&example::blob_bytes());
        let factory = keys(1);
        let identity = IdentityRecord { key: FactoryKey::Asked(*factory.pk), ..IdentityRecord::new(example::SERIAL) };
        let mut link = Link::new(VirtualLine::with(identity, flash));
        assert_eq!(link.state().expect("a perfect line").provenance, None);
        let unsigned = Err(LinkError::Refused(Refusal::Unsigned));
        assert_eq!(asking(FactoryKey::Spoilt).upload(&signed_by(&factory, &example::blob())), unsigned);
    }

    #[test]
    fn an_instrument_without_a_key_takes_signed_ones_too() {
        let signed = signed_by(&keys(1), &example::blob());
        let mut link = asking(FactoryKey::NotAsked);
        assert_eq!(link.upload(&signed), Ok(Kept::ForGood));
        let mut host = Compensator::load(&example::blob()).expect("the example is sound");
        let sample: Sample = example::samples(1)[0];
        assert!(link.replay(&sample).expect("a perfect line").same_bits(&host.compensate(&sample)));
    }
}
