//! Claim: a damaged, foreign or future calibration is refused with its reason, and the old one runs on.

use firmware_core::program::ProgramError;
use firmware_core::{Compensator, LoadError};
use firmware_sim::link::{Kept, LinkError};
use firmware_sim::virtual_instrument::VirtualInstrument;
use protocol::limits::MAX_BLOB;
use protocol::{Blob, BlobError, Reading, Refusal, Sample, Term, Weights, crc32};
use tests::workspace::root;
use tests::{example, golden};

/// What a damaged byte at an offset may be called.
fn reasons(offset: usize) -> &'static [&'static str] {
    match offset {
        0..4 => &["not a blob"],
        4..6 => &["layout"],
        // A wrong length moves the checksum: beyond the end, or onto other bytes.
        6..8 => &["truncated", "checksum"],
        _ => &["checksum"],
    }
}

fn name(error: BlobError) -> &'static str {
    match error {
        BlobError::Truncated { .. } => "truncated",
        BlobError::NotABlob => "not a blob",
        BlobError::Layout { .. } => "layout",
        BlobError::Checksum { .. } => "checksum",
        BlobError::Payload => "payload",
        _ => "too large",
    }
}

/// Bytes with the last four replaced by the right checksum, as a faulty writer would leave them.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 4;
    let checksum = crc32(&bytes[..end]).to_le_bytes();
    bytes[end..].copy_from_slice(&checksum);
    bytes
}

/// An instrument that runs the example, and a short recording with the readings that it must keep giving.
struct Bench {
    instrument: VirtualInstrument,
    samples: Vec<Sample>,
    readings: Vec<Reading>,
}

impl Bench {
    fn new() -> Self {
        let mut instrument = VirtualInstrument::new(example::SERIAL);
        instrument.upload(&example::blob()).expect("the example is sound");
        let mut compensator = Compensator::load(&example::blob()).expect("the example is sound");
        let samples = example::samples(10);
        let readings = samples.iter().map(|sample| compensator.compensate(sample)).collect();
        Self { instrument, samples, readings }
    }

    fn upload(&mut self, bytes: &[u8]) -> Result<Kept, LinkError> {
        self.instrument.link_mut().upload(bytes)
    }

    fn assert_the_old_calibration_runs_on(&mut self) {
        self.instrument.link_mut().restart().expect("a perfect line");
        let readings = self.instrument.replay(&self.samples).expect("a perfect line");
        assert!(readings.iter().zip(&self.readings).all(|(found, expected)| found.same_bits(expected)));
    }
}

#[test]
fn every_flipped_bit_is_refused_with_the_reason_of_its_region() {
    let sound = example::blob_bytes();
    for bit in 0..sound.len() * 8 {
        let mut bytes = sound.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let reason = name(Blob::from_bytes(&bytes).expect_err("a flipped bit"));
        assert!(reasons(bit / 8).contains(&reason), "bit {bit}: {reason}");
    }
}

#[test]
fn every_truncation_is_refused_as_a_truncation() {
    let sound = example::blob_bytes();
    for length in 0..sound.len() {
        let reason = name(Blob::from_bytes(&sound[..length]).expect_err("a truncation"));
        assert_eq!(reason, "truncated", "cut to {length} bytes");
    }
}

#[test]
fn erased_flash_behind_a_blob_does_not_matter() {
    let mut bytes = example::blob_bytes();
    bytes.resize(MAX_BLOB, 0xFF);
    assert_eq!(Blob::from_bytes(&bytes), Ok(example::blob()));
}

#[test]
fn the_old_calibration_survives_every_flipped_bit() {
    let sound = example::blob_bytes();
    let mut bench = Bench::new();
    for bit in 0..sound.len() * 8 {
        let mut bytes = sound.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert!(matches!(bench.upload(&bytes), Err(LinkError::Refused(_))), "bit {bit}");
        bench.assert_the_old_calibration_runs_on();
    }
}

#[test]
fn the_old_calibration_survives_every_truncation() {
    let sound = example::blob_bytes();
    let mut bench = Bench::new();
    for length in 0..sound.len() {
        assert_eq!(bench.upload(&sound[..length]), Err(LinkError::Refused(Refusal::Truncated)), "{length} bytes");
        bench.assert_the_old_calibration_runs_on();
    }
}

#[test]
fn a_blob_from_the_future_is_refused_by_its_version_and_not_as_corrupted() {
    let mut bytes = example::blob_bytes();
    bytes[4] += 1;
    let bytes = sealed(bytes);
    assert_eq!(Blob::from_bytes(&bytes), Err(BlobError::Layout { found: 3, supported: 2 }));
    let mut bench = Bench::new();
    assert_eq!(bench.upload(&bytes), Err(LinkError::Refused(Refusal::Layout(3))));
    bench.assert_the_old_calibration_runs_on();
}

#[test]
fn a_sound_checksum_over_nonsense_is_refused() {
    let mut bytes = example::blob_bytes();
    bytes[8] = 0xFF;
    let bytes = sealed(bytes);
    assert_eq!(Blob::from_bytes(&bytes), Err(BlobError::Payload));
    let mut bench = Bench::new();
    assert_eq!(bench.upload(&bytes), Err(LinkError::Refused(Refusal::Unusable)));
    bench.assert_the_old_calibration_runs_on();
}

#[test]
fn surplus_bytes_in_a_sealed_payload_are_refused() {
    for surplus in [&[0][..], &[0xFF; 7], b"TPCO"] {
        let mut bytes = example::blob_bytes();
        let length = u16::from_le_bytes([bytes[6], bytes[7]]) + surplus.len() as u16;
        bytes[6..8].copy_from_slice(&length.to_le_bytes());
        let checksum_at = bytes.len() - 4;
        bytes.splice(checksum_at..checksum_at, surplus.iter().copied());
        let bytes = sealed(bytes);
        assert_eq!(Blob::from_bytes(&bytes), Err(BlobError::Payload), "{surplus:?}");
        let mut bench = Bench::new();
        assert_eq!(bench.upload(&bytes), Err(LinkError::Refused(Refusal::Unusable)));
        bench.assert_the_old_calibration_runs_on();
    }
}

#[test]
fn a_blob_for_another_sensor_is_refused_and_one_for_any_sensor_is_not() {
    let mut bench = Bench::new();
    let mut blob = example::blob();
    blob.serial = "EXAMPLE-2".try_into().expect("a short name");
    assert_eq!(bench.instrument.upload(&blob), Err(LinkError::Refused(Refusal::OtherSerial)));
    bench.assert_the_old_calibration_runs_on();
    blob.serial.clear();
    assert_eq!(bench.instrument.upload(&blob), Ok(Kept::ForGood));
    bench.assert_the_old_calibration_runs_on();
}

/// An effect whose formula is this program.
fn own(program: &[u8]) -> Term {
    Term { program: program.iter().copied().collect(), ..example::term(22, &[1e-3, 35.0]) }
}

/// A change that makes the example unusable.
type Spoil = fn(&mut Blob);

#[test]
fn a_calibration_that_cannot_be_run_is_refused_with_its_reason() {
    let unknown = LoadError::UnknownEffect(999);
    let few = LoadError::Coefficients { effect: 1, found: 0, expected: 1 };
    let many = LoadError::Coefficients { effect: 1, found: 2, expected: 1 };
    let channel = LoadError::Channel { effect: 6 };
    let surplus = LoadError::Program { effect: 1, why: ProgramError::Surplus };
    let unsound = LoadError::Program { effect: 22, why: ProgramError::Operand };
    let unnamed = LoadError::Channel { effect: 22 };
    let table: [(&str, Spoil, LoadError); 19] = [
        ("unknown effect", |b| b.terms[0].effect = 999, unknown),
        ("too few coefficients", |b| b.terms[0].parameters.clear(), few),
        ("too many coefficients", |b| b.terms[0].parameters.push(1.0).expect("room"), many),
        ("a channel beyond the named ones", |b| b.terms[5].channel = 1, channel),
        ("no channel named", |b| b.channels.clear(), channel),
        ("a program where none belongs", |b| b.terms[0].program.push(0x01).expect("room"), surplus),
        ("a program that can't be run", |b| b.terms[5] = own(&[0x01, 0x10]), unsound),
        ("a program that reads a channel without a name", |b| b.terms[5] = own(&[0x81]), unnamed),
        ("an infinite weight", |b| b.weights.input[4][1] = f32::INFINITY, LoadError::Number),
        ("a weight that is no number", |b| b.weights.output_bias = f32::NAN, LoadError::Number),
        ("an infinite coefficient", |b| b.terms[1].parameters[0] = f32::NEG_INFINITY, LoadError::Number),
        ("a line that is no number", |b| b.scaling.line_g[3] = f32::NAN, LoadError::Number),
        ("a gain of zero", |b| b.scaling.delta_f_gain_per_hz = 0.0, LoadError::Number),
        ("a negative gain", |b| b.scaling.temperature_gain_per_c = -1.0, LoadError::Number),
        ("outputs beyond f32", |b| b.weights = Weights::from_array(&[f32::MAX; 41]), LoadError::Number),
        ("no temperatures", |b| b.domain.temperature_uc = (5, 5), LoadError::Domain),
        ("no frequencies", |b| b.domain.delta_f_uhz = (1, 0), LoadError::Domain),
        ("one frequency", |b| b.domain.delta_f_uhz = (1, 1), LoadError::Domain),
        ("a temperature gain of zero", |b| b.scaling.temperature_gain_per_c = 0.0, LoadError::Number),
    ];
    let mut bench = Bench::new();
    for (what, spoil, expected) in table {
        let mut blob = example::blob();
        spoil(&mut blob);
        assert_eq!(Compensator::load(&blob).err(), Some(expected), "{what}");
        assert_eq!(bench.instrument.upload(&blob), Err(LinkError::Refused(Refusal::Unusable)), "{what}");
    }
    bench.assert_the_old_calibration_runs_on();
}

#[test]
fn a_proof_of_other_bits_is_refused() {
    let mut blob = example::blob();
    let computed = blob.proof;
    blob.proof ^= 1;
    let stored = blob.proof;
    assert_eq!(Compensator::load(&blob).err(), Some(LoadError::Proof { computed, stored }));
}

#[test]
fn a_buffer_that_is_too_small_is_reported_for_every_size() {
    let needed = example::blob_bytes().len();
    for size in 0..needed {
        assert_eq!(example::blob().to_bytes(&mut vec![0; size]).err(), Some(BlobError::TooLarge), "{size} bytes");
    }
    assert!(example::blob().to_bytes(&mut vec![0; needed]).is_ok());
}

#[test]
fn blobs_of_layout_2_are_the_recorded_bytes() {
    golden::check("blob-v2.bin", &example::stored(&example::with_expression()));
}

#[test]
fn a_blob_of_layout_1_is_refused_by_its_version() {
    let bytes = std::fs::read(root().join("tests/golden/blob-v1.bin")).expect("the recorded bytes");
    assert_eq!(Blob::from_bytes(&bytes), Err(BlobError::Layout { found: 1, supported: 2 }));
    let mut bench = Bench::new();
    assert_eq!(bench.upload(&bytes), Err(LinkError::Refused(Refusal::Layout(1))));
    bench.assert_the_old_calibration_runs_on();
}
