//! Whether a calibration is the factory's: an Ed25519 signature by the key that the identity record holds.
//!
//! Verifying takes more flash than all the rest, so it is a variant of the image, the feature `signatures`
//! (`docs/decisions/0007-signatures.md`). Without it an instrument that holds a key takes no calibration at all.

use crate::identity::FactoryKey;
use protocol::{Refusal, Signed};

/// Checks the signature behind a calibration, if the instrument asks for one.
///
/// # Errors
/// [`Refusal::Unsigned`].
pub fn check(bytes: &[u8], key: &FactoryKey) -> Result<(), Refusal> {
    let accepted = match key {
        FactoryKey::NotAsked => true,
        FactoryKey::Spoilt => false,
        FactoryKey::Asked(key) => Signed::split(bytes)
            .is_some_and(|signed| signed.signature.is_some_and(|signature| verify(key, signed.blob, signature))),
    };
    if accepted { Ok(()) } else { Err(Refusal::Unsigned) }
}

#[cfg(feature = "signatures")]
fn verify(key: &[u8; 32], message: &[u8], signature: &[u8; 64]) -> bool {
    let signature = ed25519_compact::Signature::new(*signature);
    ed25519_compact::PublicKey::new(*key).verify(message, &signature).is_ok()
}

#[cfg(not(feature = "signatures"))]
fn verify(_: &[u8; 32], _: &[u8], _: &[u8; 64]) -> bool {
    false
}

#[cfg(all(test, not(feature = "signatures")))]
mod tests {
    #[test]
    fn an_image_that_can_check_no_signature_believes_none() {
        assert!(!super::verify(&[7; 32], b"a blob", &[7; 64]));
    }
}
