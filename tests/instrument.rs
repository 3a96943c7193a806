//! Claim: the instrument gives the host's bits, and never a number that it can't answer for.

use firmware_core::{Compensator, Counter, CounterError, Pair, Thermometer, ThermometerError};
use firmware_sim::link::{Link, LinkError, Transport};
use firmware_sim::virtual_counter::VirtualCounter;
use firmware_sim::virtual_fault::PartFault;
use firmware_sim::virtual_faulty_line::{FaultyLine, LineFaults};
use firmware_sim::virtual_instrument::VirtualInstrument;
use firmware_sim::virtual_line::VirtualLine;
use firmware_sim::virtual_thermometer::VirtualThermometer;
use proptest::prelude::*;
use protocol::limits::{MAX_CHUNK, MAX_STORED};
use protocol::{Decoder, Envelope, Reading, Refusal, Request, Response, Sample, Status, encode_frame, encode_request};
use tests::{example, golden};

/// The effect that follows a channel.
const SUPPLY_VOLTAGE: u16 = 6;
const F1_HZ: f64 = 41_238.0;
const F2_HZ: f64 = 41_162.0;
const ROOM_C: f64 = 25.0;

fn calibrated() -> VirtualInstrument {
    let mut instrument = VirtualInstrument::new(example::SERIAL);
    instrument.upload(&example::blob()).expect("the example is sound");
    instrument
}

fn on_the_host(samples: &[Sample]) -> Vec<Reading> {
    let mut compensator = Compensator::load(&example::blob()).expect("the example is sound");
    samples.iter().map(|sample| compensator.compensate(sample)).collect()
}

fn assert_same_bits(samples: &[Sample], expected: &[Reading], found: &[Reading]) {
    assert_eq!(expected.len(), found.len());
    for ((sample, expected), found) in samples.iter().zip(expected).zip(found) {
        assert!(expected.same_bits(found), "{sample:?}\nexpected {expected:?}\nfound    {found:?}");
    }
}

#[test]
fn readings_over_the_line_are_the_hosts_bit_for_bit() {
    let samples = example::samples(3000);
    let readings = calibrated().replay(&samples).expect("a perfect line");
    assert_same_bits(&samples, &on_the_host(&samples), &readings);
}

#[test]
fn the_readings_have_the_recorded_bits() {
    let samples = example::samples(2000);
    let lines: Vec<String> = on_the_host(&samples)
        .iter()
        .map(|reading| format!("{:08x} {:04x}\n", reading.acceleration_g.to_bits(), reading.status.bits()))
        .collect();
    golden::check("readings-v1.txt", lines.concat().as_bytes());
}

#[test]
fn a_reading_is_a_number_exactly_where_no_fatal_flag_is_raised() {
    for reading in on_the_host(&example::samples(2000)) {
        let fatal = reading.status.intersects(Status::FATAL);
        assert_eq!(reading.acceleration_g.is_finite(), !fatal, "{reading:?}");
        assert!(!fatal || reading.acceleration_g.to_bits() == Reading::NO_NUMBER.to_bits(), "{reading:?}");
    }
}

#[test]
fn an_effect_whose_channel_was_not_measured_is_left_out_and_flagged() {
    let mut without = example::blob();
    without.terms.retain(|term| term.effect != SUPPLY_VOLTAGE);
    let mut with = Compensator::load(&example::blob()).expect("the example is sound");
    let mut without = Compensator::load(&without).expect("the example is sound");
    for mut sample in example::samples(200) {
        sample.channels[0] = Sample::NOT_MEASURED;
        let expected = without.compensate(&sample);
        let found = with.compensate(&sample);
        assert_eq!(found.acceleration_g.to_bits(), expected.acceleration_g.to_bits());
        let missing = if sample.faults.intersects(Status::FATAL) { Status::empty() } else { Status::CHANNEL_MISSING };
        assert_eq!(found.status, expected.status | missing);
    }
}

#[test]
fn an_uncalibrated_instrument_says_so_and_gives_no_number() {
    let mut instrument = VirtualInstrument::new(example::SERIAL);
    let samples = example::samples(100);
    for (sample, reading) in samples.iter().zip(instrument.replay(&samples).expect("a perfect line")) {
        assert!(reading.same_bits(&Reading::none(sample.time_us, sample.faults | Status::UNCALIBRATED)));
    }
    let state = instrument.link_mut().state().expect("a perfect line");
    assert_eq!((state.provenance, state.readings), (None, 100));
}

#[test]
fn a_live_measurement_is_the_compensation_of_what_the_drivers_read() {
    let mut instrument = calibrated();
    let mut compensator = Compensator::load(&example::blob()).expect("the example is sound");
    for second in 1..=50_u32 {
        instrument.set(F1_HZ + f64::from(second), F2_HZ - f64::from(second) * 0.7, ROOM_C + f64::from(second) * 0.31);
        instrument.set_time_us(u64::from(second) * 1_000_000);
        let (sample, reading) = instrument.measure().expect("a perfect line");
        assert_eq!((sample.time_us, sample.faults), (u64::from(second) * 1_000_000, Status::empty()));
        // The example knows an effect of the supply voltage, which this instrument does not measure.
        assert!(reading.status.contains(Status::CHANNEL_MISSING));
        // 7.8125 m°C is a step of the thermometer, 1 mHz more than two counts of the counter.
        assert!((f64::from(sample.temperature_uc) * 1e-6 - ROOM_C - f64::from(second) * 0.31).abs() <= 0.003_907);
        assert!((sample.delta_f_uhz as f64 * 1e-6 - (F1_HZ - F2_HZ) - f64::from(second) * 1.7).abs() <= 0.001);
        assert!(reading.same_bits(&compensator.compensate(&sample)));
    }
}

proptest! {
    #[test]
    fn frequencies_are_what_the_registers_say_rounded_once(
        cycles in 1..=u32::MAX, spare in any::<u32>(), reference_hz in 1..=u32::MAX,
    ) {
        let ticks = cycles.saturating_add(spare);
        let mut counter = Counter::new(VirtualCounter::new(reference_hz, 1), reference_hz);
        // The second resonator is as fast as the reference.
        let counts = [cycles, ticks, cycles, cycles].map(u32::to_be_bytes);
        counter.device_mut().store(2, &[0, 1]);
        counter.device_mut().store(4, counts.as_flattened());
        let Pair { f1_uhz, f2_uhz } = counter.frequencies().expect("sound counts");
        prop_assert_eq!(u128::from(f1_uhz), rounded_uhz(cycles, ticks, reference_hz));
        prop_assert_eq!(u128::from(f2_uhz), u128::from(reference_hz) * 1_000_000);
    }
}

/// cycles · f_ref / ticks in µHz, to the nearest, halves up; in integers that hold the whole product.
fn rounded_uhz(cycles: u32, ticks: u32, reference_hz: u32) -> u128 {
    let (cycles, ticks, reference_hz) = (u128::from(cycles), u128::from(ticks), u128::from(reference_hz));
    (2 * cycles * reference_hz * 1_000_000 + ticks) / (2 * ticks)
}

#[test]
fn every_value_of_the_temperature_register_is_its_temperature_or_a_fault() {
    const ADDRESS: u8 = 0x48;
    let mut thermometer = Thermometer::new(VirtualThermometer::new(ADDRESS), ADDRESS);
    for bits in 0..=u16::MAX {
        thermometer.bus_mut().force_register(bits);
        let steps = bits.cast_signed();
        let temperature_c = f64::from(steps) * 0.007_812_5;
        match thermometer.temperature_uc(0) {
            Ok(found_uc) => {
                assert!((-60.0..=155.0).contains(&temperature_c));
                assert!((f64::from(found_uc) - temperature_c * 1e6).abs() <= 0.5);
            }
            Err(ThermometerError::NotReady) => assert_eq!(bits, 0x8000),
            Err(error) => assert!(!(-60.0..=155.0).contains(&temperature_c), "{error:?} at {temperature_c} °C"),
        }
    }
}

#[test]
fn what_has_measured_nothing_yet_is_stale_in_both_its_parts() {
    let (sample, reading) = VirtualInstrument::new(example::SERIAL).measure().expect("a perfect line");
    let faults = Status::RESONATOR_FAULT | Status::THERMOMETER_FAULT | Status::STALE;
    assert_eq!((sample.faults, reading.status), (faults, faults | Status::UNCALIBRATED));
}

#[test]
fn a_part_that_is_another_one_is_named() {
    let mut counter = VirtualCounter::new(1, 1);
    counter.fault = PartFault::OtherPart(0xBEEF);
    assert_eq!(Counter::new(counter, 1).check(), Err(CounterError::WrongPart(0xBEEF)));
    let mut thermometer = VirtualThermometer::new(0x48);
    thermometer.fault = PartFault::OtherPart(0x0190);
    assert_eq!(Thermometer::new(thermometer, 0x48).check(), Err(ThermometerError::WrongPart(0x0190)));
    assert_eq!(Counter::new(VirtualCounter::new(1, 1), 1).check(), Ok(()));
    assert_eq!(Thermometer::new(VirtualThermometer::new(0x48), 0x48).check(), Ok(()));
}

#[test]
fn a_repeated_request_is_answered_again_and_not_carried_out_again() {
    let mut line = VirtualLine::new(example::SERIAL);
    let body = Request::Replay(example::samples(1)[0]);
    let request = encode_request(&Envelope { sequence: 9, body }).expect("it fits");
    let answers: Vec<Vec<u8>> = (0..3).map(|_| answer_to(&mut line, &request)).collect();
    assert!(!answers[0].is_empty() && answers.iter().all(|answer| *answer == answers[0]));
    assert_eq!(Link::new(line).state().expect("a perfect line").readings, 1);
}

#[test]
fn a_new_conversation_never_gets_an_answer_of_the_one_before() {
    let mut line = VirtualLine::new(example::SERIAL);
    for readings in 0..3 {
        let mut link = Link::new(&mut line);
        assert_eq!(link.state().expect("a perfect line").readings, readings);
        link.replay(&example::samples(1)[0]).expect("a perfect line");
    }
}

#[test]
fn a_request_from_the_future_is_refused_by_its_number() {
    let mut line = VirtualLine::new(example::SERIAL);
    let request = encode_frame(&Envelope { sequence: 300, body: (99_u8, 1_u8) }).expect("it fits");
    let mut decoder = Decoder::new();
    let answer = answer_to(&mut line, &request).into_iter().find_map(|byte| decoder.push::<Response>(byte));
    let body = Response::Refused(Refusal::UnknownRequest);
    assert_eq!(answer, Some(Ok(Envelope { sequence: 300, body })));
}

#[test]
fn a_calibration_may_fill_the_room_for_one_and_a_byte_more_changes_nothing() {
    let mut link = Link::new(VirtualLine::new(example::SERIAL));
    link.unlock().expect("a perfect line");
    let mut write = |offset: usize, count: usize| {
        let bytes = vec![0xAB; count].as_slice().try_into().expect("a piece");
        link.exchange(Request::WriteBlob { offset: offset as u16, bytes }).expect("a perfect line")
    };
    for offset in (0..MAX_STORED).step_by(MAX_CHUNK) {
        assert_eq!(write(offset, MAX_CHUNK.min(MAX_STORED - offset)), Response::Done, "{offset}");
    }
    assert_eq!(write(MAX_STORED - 10, 11), Response::Refused(Refusal::Unusable));
    // All of it is still there: nonsense, but not too little of it.
    let answer = link.exchange(Request::CommitBlob { length: MAX_STORED as u16 }).expect("a perfect line");
    let Response::Refused(refusal) = answer else { panic!("nonsense was taken: {answer:?}") };
    assert!(refusal != Refusal::Truncated && refusal != Refusal::Locked, "{refusal:?}");
}

#[test]
fn a_dead_line_is_reported_after_the_stated_number_of_tries() {
    let faults = LineFaults { loss_ppm: 1_000_000, ..LineFaults::default() };
    let mut link = Link::new(FaultyLine::new(VirtualLine::new(example::SERIAL), faults, 1)).with_tries(3);
    assert_eq!(link.identify(), Err(LinkError::NoAnswer { tries: 3 }));
}

fn answer_to(line: &mut VirtualLine, request: &[u8]) -> Vec<u8> {
    let Ok(()) = line.send(request);
    std::iter::from_fn(|| line.receive().expect("this line can't fail")).collect()
}
