//! A running hash, cheap on a core without a multiplier of its own.

use protocol::Reading;

/// What has come out so far, in 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest {
    hash: u64,
    /// Outputs that were numbers.
    pub numbers: u32,
}

impl Default for Digest {
    fn default() -> Self {
        Self { hash: 0xCBF2_9CE4_8422_2325, numbers: 0 }
    }
}

impl Digest {
    /// Takes an output. Processors disagree on the bits of a NaN that arithmetic makes, so all NaN are one;
    /// the product makes its own, which [`Digest::reading`] takes as it is.
    pub fn value(&mut self, value: f32) {
        self.numbers += u32::from(value.is_finite());
        self.word(if value.is_nan() { Reading::NO_NUMBER.to_bits() } else { value.to_bits() });
    }

    /// Takes a reading, status and time included.
    pub fn reading(&mut self, reading: &Reading) {
        self.numbers += u32::from(reading.acceleration_g.is_finite());
        self.word(reading.acceleration_g.to_bits());
        self.word(u32::from(reading.status.bits()));
        self.word(reading.time_us as u32);
    }

    /// Takes another digest.
    pub fn digest(&mut self, other: &Self) {
        self.numbers += other.numbers;
        self.word((other.hash >> 32) as u32);
        self.word(other.hash as u32);
    }

    /// The hash of everything taken.
    #[must_use]
    pub const fn hash(&self) -> u64 {
        self.hash
    }

    fn word(&mut self, word: u32) {
        // FNV-1a over words, and a turn so that high bits come down.
        self.hash = (self.hash ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01B3).rotate_left(23);
    }
}
