//! Everything that the instrument computes, part by part, as hashes.

use crate::{Digest, Numbers, Samples, calibrations};
use firmware_core::{Compensator, Network};
use protocol::Blob;
use protocol::limits::MAX_BLOB;

/// How many parts there are.
pub const PARTS: u32 = calibrations::ALL.len() as u32 + 1;

/// Computes every part from `each` samples and hands it over with its name; `None` where a calibration was refused.
pub fn parts(each: u32, mut take: impl FnMut(&str, Option<Digest>)) {
    take("floats", Some(floats(each)));
    for (name, blob) in calibrations::ALL {
        take(name, readings(&blob(), each));
    }
}

/// The network alone.
fn floats(count: u32) -> Digest {
    let network = Network::<f32>::new(&calibrations::bare().weights);
    let mut digest = Digest::default();
    (0..count).zip(Numbers::default()).for_each(|(_, [x, t])| digest.value(network.evaluate(x, t)));
    digest
}

/// The whole path: the calibration through its bytes and checks, then from samples to readings.
fn readings(blob: &Blob, count: u32) -> Option<Digest> {
    let mut buffer = [0; MAX_BLOB];
    let stored = Blob::from_bytes(blob.to_bytes(&mut buffer).ok()?).ok()?;
    let mut compensator = Compensator::load(&stored).ok()?;
    let mut digest = Digest::default();
    (0..count).zip(Samples::default()).for_each(|(_, sample)| digest.reading(&compensator.compensate(&sample)));
    Some(digest)
}
