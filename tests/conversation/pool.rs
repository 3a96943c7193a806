//! Calibrations to be written, and what must become of each.

use ed25519_compact::{KeyPair, Seed};
use firmware_core::FactoryKey;
use protocol::{Blob, Refusal, Signed};
use tests::example;

/// One calibration.
pub struct Calibration {
    pub blob: Blob,
    bytes: Vec<u8>,
    /// The factory's signature.
    trailer: Vec<u8>,
    /// Why this instrument can't use it, whoever signed it.
    wrong: Option<Refusal>,
}

/// All of them, for an instrument with one kind of key.
pub struct Pool {
    pub key: FactoryKey,
    calibrations: Vec<Calibration>,
    /// What a host may send: unsigned, signed by the factory, signed by somebody, nonsense.
    pub sent: Vec<Vec<u8>>,
}

impl Pool {
    pub fn new(key: FactoryKey) -> Self {
        let (factory, somebody) = (keys(1), keys(2));
        let signed = |keys: &KeyPair, bytes: &[u8]| Signed::trailer(&keys.sk.sign(bytes, None)).to_vec();
        let calibration = |(blob, wrong): (Blob, Option<Refusal>)| {
            let bytes = example::stored(&blob);
            Calibration { trailer: signed(&factory, &bytes), bytes, blob, wrong }
        };
        let calibrations: Vec<Calibration> = blobs().into_iter().map(calibration).collect();
        let mut sent = Vec::new();
        for Calibration { bytes, trailer, .. } in &calibrations {
            sent.extend([bytes.clone(), [&bytes[..], trailer].concat()]);
        }
        sent.push([&calibrations[0].bytes[..], &signed(&somebody, &calibrations[0].bytes)].concat());
        sent.push(vec![0x55; 100]);
        Self { key, calibrations, sent }
    }

    /// The key of the factory that signed.
    pub fn factory() -> FactoryKey {
        FactoryKey::Asked(*keys(1).pk)
    }

    /// The calibration that these bytes begin with, or why it is refused, if that can be foretold.
    pub fn verdict(&self, bytes: &[u8]) -> Result<&Calibration, Option<Refusal>> {
        let found = self.calibrations.iter().find(|calibration| bytes.starts_with(&calibration.bytes)).ok_or(None)?;
        let is_signed = bytes[found.bytes.len()..].starts_with(&found.trailer);
        let trusted = match self.key {
            FactoryKey::NotAsked => true,
            FactoryKey::Asked(_) => is_signed,
            FactoryKey::Spoilt => false,
        };
        match found.wrong {
            Some(Refusal::OtherSerial) => Err(Some(Refusal::OtherSerial)),
            _ if !trusted => Err(Some(Refusal::Unsigned)),
            Some(other) => Err(Some(other)),
            None => Ok(found),
        }
    }

    /// What the instrument shows of its key.
    pub fn key_shown(&self) -> Option<[u8; 8]> {
        match self.key {
            FactoryKey::NotAsked => None,
            FactoryKey::Asked(key) => key.first_chunk().copied(),
            FactoryKey::Spoilt => Some([0; 8]),
        }
    }
}

fn keys(seed: u8) -> KeyPair {
    KeyPair::from_seed(Seed::new([seed; 32]))
}

/// Sound ones of different lengths, and one for each reason to refuse it.
fn blobs() -> Vec<(Blob, Option<Refusal>)> {
    let numbered = |number: u8| {
        let mut blob = Blob { provenance: [number; 8], ..example::blob() };
        blob.terms.truncate(usize::from(number));
        blob
    };
    let serial = |text: &str| text.try_into().expect("a short name");
    let mut unknown = numbered(4);
    unknown.terms[0].effect = 999;
    vec![
        (numbered(1), None),
        (numbered(3), None),
        (Blob { serial: serial(""), ..example::with_expression() }, None),
        (Blob { serial: serial("OTHER-9"), ..numbered(2) }, Some(Refusal::OtherSerial)),
        (unknown, Some(Refusal::Unusable)),
    ]
}
