//! What must hold for any bytes at all. `fuzz/` searches for bytes for which it does not, `tests/fuzz_corpus.rs` tries
//! the corpus and mutations of it.

#[cfg(feature = "training")]
mod files;

use crate::example;
use firmware_core::{Compensator, Network};
use protocol::limits::MAX_BLOB;
use protocol::{Blob, Decoder, Envelope, Reading, Request, Response, Sample, Status, crc32, encode_frame};
use serde::Serialize;
use serde::de::DeserializeOwned;

#[cfg(feature = "training")]
pub use files::{campaign, expression, intel_hex, mapping, model, scenario, sealed_truth};

/// A property of any bytes; it panics where it does not hold.
pub type Target = fn(&[u8]);

/// Every target with the name of its corpus.
#[cfg(feature = "training")]
pub const TARGETS: [(&str, Target); 9] = [
    ("frame", frame),
    ("blob", blob),
    ("campaign", campaign),
    ("mapping", mapping),
    ("expression", expression),
    ("model", model),
    ("scenario", scenario),
    ("sealed_truth", sealed_truth),
    ("intel_hex", intel_hex),
];

/// Whatever comes along the line: refused, or a message that survives being sent again.
///
/// # Panics
/// If that does not hold.
pub fn frame(bytes: &[u8]) {
    // The checksum keeps nearly everything out; a faulty sender has the right one.
    for line in [bytes, &framed(bytes)] {
        messages::<Request>(line);
        messages::<Response>(line);
    }
}

/// These bytes as the contents of a frame: with their checksum, every zero replaced as byte stuffing does it.
fn framed(message: &[u8]) -> Vec<u8> {
    let body = [message, &crc32(message).to_le_bytes()].concat();
    let mut line = Vec::new();
    for group in body.split(|byte| *byte == 0) {
        let (full, rest) = group.as_chunks::<254>();
        for piece in full {
            line.push(0xFF);
            line.extend(piece);
        }
        line.push(rest.len() as u8 + 1);
        line.extend(rest);
    }
    line
}

fn messages<T: Serialize + DeserializeOwned>(bytes: &[u8]) {
    let mut decoder = Decoder::new();
    for byte in bytes.iter().chain(&[0]) {
        if let Some(Ok(message)) = decoder.push::<T>(*byte) {
            let sent = encode_frame(&message).expect("what fitted a frame fits one again");
            let mut receiver = Decoder::new();
            let received: Option<Result<Envelope<T>, _>> = sent.iter().find_map(|byte| receiver.push(*byte));
            let received = received.expect("a whole frame").expect("a sound one");
            // Compared as bytes: a reading may hold a NaN, which differs from itself.
            assert_eq!(encode_frame(&received), Ok(sent));
        }
    }
}

/// Whatever is found where a calibration should be: refused, or run with readings that are numbers or say why not.
///
/// # Panics
/// If that does not hold.
pub fn blob(bytes: &[u8]) {
    if let Ok(blob) = Blob::from_bytes(bytes) {
        stored_and_run(blob);
    }
    // The checksum keeps nearly everything out; a faulty writer has the right one.
    if let Ok(blob) = Blob::from_bytes(&sealed(bytes)) {
        stored_and_run(blob);
    }
}

/// These bytes as the payload of a calibration, with header and checksum.
fn sealed(payload: &[u8]) -> Vec<u8> {
    let length = u16::try_from(payload.len()).unwrap_or(u16::MAX);
    let header = [b"TPCO".as_slice(), &Blob::LAYOUT.to_le_bytes(), &length.to_le_bytes()];
    let mut bytes: Vec<u8> = header.concat().into_iter().chain(payload.iter().copied()).collect();
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}

fn stored_and_run(mut blob: Blob) {
    let mut buffer = [0; MAX_BLOB];
    if let Ok(stored) = blob.to_bytes(&mut buffer) {
        let again = Blob::from_bytes(stored).expect("what was written is read");
        assert_eq!(again.to_bytes(&mut [0; MAX_BLOB]), Ok(stored));
    }
    // Numbers only are looked at: without this the proof keeps nearly every network out.
    if let Some(proof) = Network::new(&blob.weights).proof() {
        blob.proof = proof;
    }
    if let Ok(mut compensator) = Compensator::load(&blob) {
        readings_are_numbers_or_say_why(&mut compensator, &example::samples(60));
    }
}

fn readings_are_numbers_or_say_why(compensator: &mut Compensator, samples: &[Sample]) {
    for sample in samples {
        let reading = compensator.compensate(sample);
        let none = reading.acceleration_g.to_bits() == Reading::NO_NUMBER.to_bits();
        let says_why = reading.status.intersects(Status::FATAL);
        assert!(if none { says_why } else { reading.acceleration_g.is_finite() }, "{sample:?}: {reading:?}");
    }
}
