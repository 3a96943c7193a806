//! A line that damages bytes: a wrapper around any line.

use crate::link::Transport;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::VecDeque;

/// How often a byte suffers, in either direction, in parts per million.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineFaults {
    /// One of its bits flips.
    pub flip_ppm: u32,
    /// It is lost.
    pub loss_ppm: u32,
    /// It arrives twice.
    pub duplication_ppm: u32,
    /// It arrives behind the byte that follows it.
    pub reordering_ppm: u32,
}

impl LineFaults {
    /// Every kind of fault, equally often.
    #[must_use]
    pub const fn each(ppm: u32) -> Self {
        Self { flip_ppm: ppm, loss_ppm: ppm, duplication_ppm: ppm, reordering_ppm: ppm }
    }
}

/// A line with seeded faults: same seed, same bytes, same damage.
#[derive(Debug)]
pub struct FaultyLine<T> {
    line: T,
    faults: LineFaults,
    random: Xoshiro256PlusPlus,
    received: VecDeque<u8>,
    /// Bytes that wait for the next one to overtake them, in either direction.
    overtaken: [Option<u8>; 2],
}

const SENT: usize = 0;
const RECEIVED: usize = 1;

impl<T: Transport> FaultyLine<T> {
    /// Damages what passes over `line`.
    #[must_use]
    pub fn new(line: T, faults: LineFaults, seed: u64) -> Self {
        let random = Xoshiro256PlusPlus::seed_from_u64(seed);
        Self { line, faults, random, received: VecDeque::new(), overtaken: [None; 2] }
    }

    /// The line underneath.
    pub const fn line_mut(&mut self) -> &mut T {
        &mut self.line
    }

    /// The line underneath, from now on without faults.
    pub fn into_line(self) -> T {
        self.line
    }

    /// What becomes of one byte: nothing, or one to three bytes.
    fn damage(&mut self, byte: u8, direction: usize) -> impl Iterator<Item = u8> + use<T> {
        let lost = self.strikes(self.faults.loss_ppm);
        let byte = if self.strikes(self.faults.flip_ppm) { byte ^ (1 << (self.random.next_u64() % 8)) } else { byte };
        let twice = self.strikes(self.faults.duplication_ppm);
        let mut passes = [Some(byte).filter(|_| !lost), Some(byte).filter(|_| twice && !lost), None];
        if let Some(overtaken) = self.overtaken[direction].take() {
            passes[2] = Some(overtaken);
        } else if !lost && self.strikes(self.faults.reordering_ppm) {
            self.overtaken[direction] = Some(byte);
            passes = [None; 3];
        }
        passes.into_iter().flatten()
    }

    fn strikes(&mut self, ppm: u32) -> bool {
        self.random.next_u64() % 1_000_000 < u64::from(ppm)
    }
}

impl<T: Transport> Transport for FaultyLine<T> {
    type Error = T::Error;

    fn send(&mut self, bytes: &[u8]) -> Result<(), T::Error> {
        let mut damaged = Vec::with_capacity(bytes.len());
        for byte in bytes {
            damaged.extend(self.damage(*byte, SENT));
        }
        self.line.send(&damaged)
    }

    fn receive(&mut self) -> Result<Option<u8>, T::Error> {
        while self.received.is_empty() {
            let Some(byte) = self.line.receive()? else { return Ok(None) };
            let bytes = self.damage(byte, RECEIVED);
            self.received.extend(bytes);
        }
        Ok(self.received.pop_front())
    }
}
