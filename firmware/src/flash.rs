//! The flash with both slots: sectors 10 and 11 of the STM32F405, erased and written by the program itself.
//!
//! The sequences are those of RM0090, section 3.6: unlock with two keys, choose what to do, wait until it is done. There
//! is one bank: while it erases, the processor waits for its next instruction, up to two seconds for a sector. Where
//! there is no such flash (QEMU has a ROM), the bytes stay as they are, and whoever wrote them reads them back.

use crate::board::{SLOT_BYTES, read_slots, write_slots};
use crate::registers::flash::{ACR, CR, KEYR, SR};
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
/// The sector of the first slot, by the manual's number.
const FIRST_SECTOR: u32 = 10;

const BUSY: u32 = 1 << 16;
/// Errors, and the end of an operation; cleared by writing ones.
const FLAGS: u32 = 0b1111_0011;
const ERRORS: u32 = 0b1111_0010;

const PROGRAM: u32 = 1 << 0;
const ERASE_SECTOR: u32 = 1 << 1;
const WORDS: u32 = 0b10 << 8;
const START: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

const DATA_CACHE: u32 = 1 << 10;
const DATA_CACHE_RESET: u32 = 1 << 12;

/// Looks at the busy flag during an erase: several seconds, where two are the longest.
const PATIENCE: u32 = 20_000_000;

/// The sectors of both slots.
pub struct Flash;

/// Why it was not done.
#[derive(Debug)]
pub enum FlashError {
    /// Protected, or the supply is too low, or the sequence was wrong.
    Failed,
    /// It did not end.
    Stuck,
    /// No such bytes.
    OutOfBounds,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Failed | Self::Stuck => NorFlashErrorKind::Other,
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
        }
    }
}

impl ErrorType for Flash {
    type Error = FlashError;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        for (at, slot) in (offset..).zip(bytes) {
            *slot = read_slots(at).ok_or(FlashError::OutOfBounds)?;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        2 * SLOT_BYTES as usize
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SLOT_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let first = from / SLOT_BYTES;
        if from % SLOT_BYTES != 0 || to > 2 * SLOT_BYTES {
            return Err(FlashError::OutOfBounds);
        }
        unlocked(|| {
            for sector in first..to / SLOT_BYTES {
                CR.write(ERASE_SECTOR | WORDS | (FIRST_SECTOR + sector) << 3);
                CR.modify(0, START);
                finished()?;
            }
            Ok(())
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let (words, rest) = bytes.as_chunks::<4>();
        if offset % 4 != 0 || !rest.is_empty() {
            return Err(FlashError::OutOfBounds);
        }
        unlocked(|| {
            CR.write(PROGRAM | WORDS);
            for (at, word) in (offset..).step_by(4).zip(words) {
                write_slots(at, u32::from_le_bytes(*word)).ok_or(FlashError::OutOfBounds)?;
                finished()?;
            }
            Ok(())
        })
    }
}

/// Does something with the flash open for writing.
fn unlocked(act: impl FnOnce() -> Result<(), FlashError>) -> Result<(), FlashError> {
    finished().ok();
    SR.write(FLAGS);
    if CR.read() & LOCK != 0 {
        KEYS.iter().for_each(|key| KEYR.write(*key));
    }
    // What the data cache holds of the sectors is no longer true afterwards.
    let cache = ACR.read() & DATA_CACHE;
    ACR.modify(DATA_CACHE, 0);
    let result = act();
    CR.write(LOCK);
    ACR.modify(0, DATA_CACHE_RESET);
    ACR.modify(DATA_CACHE_RESET, cache);
    result
}

/// Waits for the end of what was begun.
fn finished() -> Result<(), FlashError> {
    let status = (0..PATIENCE).map(|_| SR.read()).find(|status| status & BUSY == 0).ok_or(FlashError::Stuck)?;
    SR.write(FLAGS);
    if status & ERRORS == 0 { Ok(()) } else { Err(FlashError::Failed) }
}
