//! The factory's keys, as files of one line of hexadecimal digits.

use crate::digits::digits;
use crate::failure::Failure;
use crate::output::{write_new, write_secret};
use ed25519_compact::{KeyPair, Seed};
use protocol::Signed;
use std::path::Path;

/// A key that signs.
pub struct SecretKey(KeyPair);

impl SecretKey {
    /// A new one.
    pub fn generate() -> Result<Self, Failure> {
        let mut seed = [0; 32];
        getrandom::fill(&mut seed)
            .map_err(|error| Failure::new(format_args!("the system gives no random numbers: {error}")))?;
        Ok(Self::of(seed))
    }

    fn of(seed: [u8; 32]) -> Self {
        Self(KeyPair::from_seed(Seed::new(seed)))
    }

    /// Reads the file that [`SecretKey::write`] wrote.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        read(path).map(Self::of)
    }

    /// Writes it for its owner's eyes only; never over an older one.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        write_secret(path, (digits(&*self.0.sk.seed()) + "\n").as_bytes())
    }

    /// What instruments hold.
    pub fn public(&self) -> [u8; 32] {
        *self.0.pk
    }

    /// A blob with its signature behind it.
    pub fn sign(&self, blob: &[u8]) -> Vec<u8> {
        let signature = self.0.sk.sign(blob, None);
        [blob, &Signed::trailer(&signature)].concat()
    }
}

/// Writes a public key; never over an older one, which instruments may hold.
pub fn write_public(path: &Path, key: &[u8; 32]) -> Result<(), Failure> {
    write_new(path, (digits(key) + "\n").as_bytes())
}

/// Reads a public key.
pub fn read_public(path: &Path) -> Result<[u8; 32], Failure> {
    read(path)
}

fn read(path: &Path) -> Result<[u8; 32], Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        Failure::io(path, &error).help("`tempco device keygen -o factory` makes factory.key and factory.pub")
    })?;
    let text = text.trim();
    let byte = |at: usize| u8::from_str_radix(text.get(2 * at..2 * at + 2)?, 16).ok();
    let key: Option<Vec<u8>> = (0..32).map(byte).collect();
    let key = key.filter(|_| text.len() == 64).and_then(|key| key.try_into().ok());
    key.ok_or_else(|| Failure::new(format_args!("{}: expected 64 hexadecimal digits, a key", path.display())))
}
