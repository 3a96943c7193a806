//! A line that damages bytes: a wrapper around any line.

use crate::link::Transport;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// How often a byte suffers, in either direction, in parts per million.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineFaults {
    /// One of its bits flips.
    pub flip_ppm: u32,
    /// It is lost.
    pub loss_ppm: u32,
    /// It arrives twice.
    pub duplication_ppm: u32,
}

/// A line with seeded faults: same seed, same bytes, same damage.
#[derive(Debug)]
pub struct FaultyLine<T> {
    line: T,
    faults: LineFaults,
    random: Xoshiro256PlusPlus,
    repeated: Option<u8>,
}

impl<T: Transport> FaultyLine<T> {
    /// Damages what passes over `line`.
    #[must_use]
    pub fn new(line: T, faults: LineFaults, seed: u64) -> Self {
        Self { line, faults, random: Xoshiro256PlusPlus::seed_from_u64(seed), repeated: None }
    }

    /// The line underneath.
    pub const fn line_mut(&mut self) -> &mut T {
        &mut self.line
    }

    /// What becomes of one byte: nothing, one byte or two.
    fn damage(&mut self, byte: u8) -> [Option<u8>; 2] {
        if self.strikes(self.faults.loss_ppm) {
            return [None, None];
        }
        let byte = if self.strikes(self.faults.flip_ppm) { byte ^ (1 << (self.random.next_u64() % 8)) } else { byte };
        [Some(byte), self.strikes(self.faults.duplication_ppm).then_some(byte)]
    }

    fn strikes(&mut self, ppm: u32) -> bool {
        self.random.next_u64() % 1_000_000 < u64::from(ppm)
    }
}

impl<T: Transport> Transport for FaultyLine<T> {
    type Error = T::Error;

    fn send(&mut self, bytes: &[u8]) -> Result<(), T::Error> {
        let damaged: Vec<u8> = bytes.iter().flat_map(|byte| self.damage(*byte)).flatten().collect();
        self.line.send(&damaged)
    }

    fn receive(&mut self) -> Result<Option<u8>, T::Error> {
        if let Some(byte) = self.repeated.take() {
            return Ok(Some(byte));
        }
        while let Some(byte) = self.line.receive()? {
            if let [Some(byte), repeated] = self.damage(byte) {
                self.repeated = repeated;
                return Ok(Some(byte));
            }
        }
        Ok(None)
    }
}
