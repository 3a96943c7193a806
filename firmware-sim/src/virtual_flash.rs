//! A NOR flash that obeys the data sheet and loses power wherever a test wants it to.
//!
//! Bits go from 1 to 0 only; an erase sets a whole sector to ones; a word is written once between two erases.
//! Every byte written and every part of an erase is a step, and power can fail within any of them: a byte may then be
//! half written, and a sector hold anything between what it held and ones.

use core::fmt;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Bytes of one slot, and of one sector.
pub const SLOT_BYTES: u32 = 4096;
/// Parts of an erase.
pub const ERASE_STEPS: u64 = 64;
const WORD: usize = 4;

/// What an erase that is cut short leaves behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EraseOrder {
    /// Ones from the first byte on, the rest as it was.
    #[default]
    FrontToBack,
    /// Ones from the last byte back, the rest as it was.
    BackToFront,
    /// All bits are brought to zero first, as many parts do, then to one.
    ZerosFirst,
    /// Every zero is by then a one or not, at random.
    Scattered(u64),
}

/// Why the flash did not do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Power failed.
    PowerLost,
    /// An address or a length that is no multiple of what it must be.
    NotAligned,
    /// Beyond the last byte.
    OutOfBounds,
    /// A word that was written since the last erase.
    WrittenTwice,
}

impl fmt::Display for FlashError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PowerLost => "power failed",
            Self::NotAligned => "not aligned",
            Self::OutOfBounds => "beyond the last byte",
            Self::WrittenTwice => "a word was written twice without an erase",
        })
    }
}

impl core::error::Error for FlashError {}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::NotAligned => NorFlashErrorKind::NotAligned,
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            Self::PowerLost | Self::WrittenTwice => NorFlashErrorKind::Other,
        }
    }
}

/// Two sectors of flash.
#[derive(Clone, Debug)]
pub struct VirtualFlash {
    /// What a cut erase leaves.
    pub order: EraseOrder,
    /// Takes nothing and reports success, as a ROM does.
    pub read_only: bool,
    bytes: Vec<u8>,
    written: Vec<bool>,
    steps: u64,
    power_fails_at: Option<u64>,
    powered: bool,
}

impl Default for VirtualFlash {
    fn default() -> Self {
        Self::new()
    }
}

impl VirtualFlash {
    /// An erased one.
    #[must_use]
    pub fn new() -> Self {
        let length = 2 * SLOT_BYTES as usize;
        Self {
            order: EraseOrder::default(),
            read_only: false,
            bytes: vec![0xFF; length],
            written: vec![false; length / WORD],
            steps: 0,
            power_fails_at: None,
            powered: true,
        }
    }

    /// One that holds these bytes, the rest erased.
    #[must_use]
    pub fn holding(bytes: &[u8]) -> Self {
        let mut flash = Self::new();
        flash.program(0, bytes);
        flash
    }

    /// The same, but an erase that is cut short leaves this behind.
    #[must_use]
    pub fn erasing(self, order: EraseOrder) -> Self {
        Self { order, ..self }
    }

    /// Puts bytes into it as a programmer does who erased the sector before.
    pub fn program(&mut self, at: usize, bytes: &[u8]) {
        for (offset, byte) in bytes.iter().enumerate().take_while(|(offset, _)| at + offset < 2 * SLOT_BYTES as usize) {
            self.bytes[at + offset] = *byte;
            self.written[(at + offset) / WORD] = true;
        }
    }

    /// All of it.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Steps done so far.
    #[must_use]
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// Lets power fail in the course of the step with this number, counted from the first one ever.
    pub const fn fail_power_at(&mut self, step: u64) {
        self.power_fails_at = Some(step);
    }

    /// Power is back, for good.
    pub const fn restore_power(&mut self) {
        self.power_fails_at = None;
        self.powered = true;
    }

    /// Begins a step; false if power fails in its course.
    fn step(&mut self) -> bool {
        self.powered = self.power_fails_at != Some(self.steps);
        self.steps += 1;
        self.powered
    }

    fn check(&self, offset: u32, length: usize, unit: usize) -> Result<usize, FlashError> {
        let at = offset as usize;
        if !self.powered {
            Err(FlashError::PowerLost)
        } else if !at.is_multiple_of(unit) || !length.is_multiple_of(unit) {
            Err(FlashError::NotAligned)
        } else if at + length > self.bytes.len() {
            Err(FlashError::OutOfBounds)
        } else {
            Ok(at)
        }
    }

    /// What a sector holds when `done` of [`ERASE_STEPS`] steps of its erase are done.
    fn half_erased(&self, sector: &mut [u8], done: u64) {
        let length = sector.len() as u64;
        let part = |steps: u64| (length * steps / ERASE_STEPS) as usize;
        match self.order {
            EraseOrder::FrontToBack => sector[..part(done)].fill(0xFF),
            EraseOrder::BackToFront => sector[(length as usize - part(done))..].fill(0xFF),
            EraseOrder::ZerosFirst if done < ERASE_STEPS / 2 => sector[..part(2 * done)].fill(0),
            EraseOrder::ZerosFirst => {
                sector.fill(0);
                sector[..part(2 * done - ERASE_STEPS)].fill(0xFF);
            }
            EraseOrder::Scattered(seed) => {
                let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
                for byte in sector {
                    let ones =
                        (0..8).filter(|_| random.next_u64() % ERASE_STEPS < done).fold(0, |ones, bit| ones | 1 << bit);
                    *byte |= ones;
                }
            }
        }
    }
}

impl ErrorType for VirtualFlash {
    type Error = FlashError;
}

impl ReadNorFlash for VirtualFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let at = self.check(offset, bytes.len(), 1)?;
        bytes.copy_from_slice(&self.bytes[at..at + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for VirtualFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SLOT_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.saturating_sub(from) as usize;
        let begin = self.check(from, length, Self::ERASE_SIZE)?;
        if self.read_only {
            return Ok(());
        }
        for at in (begin..begin + length).step_by(Self::ERASE_SIZE) {
            let mut sector = self.bytes[at..at + Self::ERASE_SIZE].to_vec();
            for done in 0..ERASE_STEPS {
                if !self.step() {
                    self.half_erased(&mut sector, done);
                    self.bytes[at..at + Self::ERASE_SIZE].copy_from_slice(&sector);
                    return Err(FlashError::PowerLost);
                }
            }
            self.bytes[at..at + Self::ERASE_SIZE].fill(0xFF);
            self.written[at / WORD..(at + Self::ERASE_SIZE) / WORD].fill(false);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let at = self.check(offset, bytes.len(), WORD)?;
        if self.read_only {
            return Ok(());
        }
        for (word, chunk) in bytes.chunks(WORD).enumerate() {
            let at = at + word * WORD;
            if std::mem::replace(&mut self.written[at / WORD], true) {
                return Err(FlashError::WrittenTwice);
            }
            for (index, byte) in chunk.iter().enumerate() {
                if !self.step() {
                    // Some of the bits that shall become zero have.
                    self.bytes[at + index] &= byte | 0x55_u8.rotate_left(self.steps as u32);
                    return Err(FlashError::PowerLost);
                }
                self.bytes[at + index] &= byte;
            }
        }
        Ok(())
    }
}
