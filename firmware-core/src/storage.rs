//! Two slots of flash, of which one is always sound: the calibration survives a power cut at any moment.
//!
//! ```text
//!   slot 0 ┌ calibration ┬ mark ┬ record ┐    slot 1 ┌ calibration ┬ mark ┬ record ┐
//!          └─────────────┴──────┴────────┘           └─────────────┴──────┴────────┘
//! ```
//! A commit never touches the slot in use. It erases the other one, marks it as begun, writes the calibration,
//! and the record last; the record's checksum makes the slot valid. The newest valid slot counts. A step back
//! erases the slot in use, and the other one counts again. Whatever a power cut leaves half written or
//! half erased fails a checksum. Nothing is written twice between two erases, as flash with
//! error correction demands.
//!
//! A bare blob at the beginning of slot 0, as a programmer writes it, has neither mark nor record. It is valid and
//! older than everything committed. Slot 1 takes none: then a slot that lost its record and its mark to a half
//! done erase can never be taken for another one.

mod record;
mod slot;

pub use slot::Slot;

use crate::storage::record::{HEADING, Heading, Mark, Record, State};
use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use protocol::limits::MAX_STORED;
use protocol::{Signed, crc32};

/// Bytes of a slot that are used; a slot is at least one erase unit of the flash.
pub const SLOT_USED: u32 = HEADING_AT + HEADING as u32;

/// Where mark and record stand: behind the longest calibration, aligned for every flash.
const HEADING_AT: u32 = 1152;
/// Bytes written or read at a time; every flash's write size divides it.
const PIECE: usize = 16;

const _: () = assert!(MAX_STORED <= HEADING_AT as usize && (HEADING_AT as usize).is_multiple_of(PIECE));

/// The bytes of a calibration as it is stored, its signature included.
pub type Bytes = Vec<u8, MAX_STORED>;

/// A calibration that a slot holds, whole and intact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stored {
    /// Where.
    pub slot: Slot,
    /// Its number in the order of commits; 0 is a programmer's.
    pub sequence: u32,
}

/// Why nothing was stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StorageError<E> {
    /// The flash reported a failure.
    Flash(E),
    /// The flash reported success and holds other bytes.
    NotTaken,
}

impl<E> From<E> for StorageError<E> {
    fn from(error: E) -> Self {
        Self::Flash(error)
    }
}

/// Both slots.
#[derive(Debug)]
pub struct Storage<F> {
    flash: F,
    slot_bytes: u32,
}

impl<F: NorFlash> Storage<F> {
    /// Two slots of `slot_bytes` each from the flash's first byte on. A slot must be a whole number of erase units
    /// and hold [`SLOT_USED`] bytes.
    pub const fn new(flash: F, slot_bytes: u32) -> Self {
        Self { flash, slot_bytes }
    }

    /// The flash, for whoever owns the hardware.
    pub const fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// The slots, the one that counts first. What they hold is still to be read.
    pub fn newest_first(&mut self) -> [Slot; 2] {
        let [first, second] = [Slot::First, Slot::Second].map(|slot| self.heading(slot).sequence(slot));
        if first >= second { [Slot::First, Slot::Second] } else { [Slot::Second, Slot::First] }
    }

    /// How often each slot has been erased, as far as power cuts between an erase and its mark did not hide it.
    pub fn erases(&mut self) -> [u32; 2] {
        let [[a, b], [c, d]] = [Slot::First, Slot::Second].map(|slot| self.heading(slot).erases);
        [a.max(c), b.max(d)]
    }

    /// Reads the calibration in a slot; `None` if there is no whole and intact one.
    pub fn read(&mut self, slot: Slot, bytes: &mut Bytes) -> Option<Stored> {
        let sequence = match self.heading(slot).state {
            State::Committed(record) => {
                self.fill(slot, bytes, record.length)?;
                (crc32(bytes) == record.checksum).then_some(record.sequence)
            }
            State::Unwritten if slot == Slot::First => {
                self.fill(slot, bytes, MAX_STORED)?;
                let signed = Signed::split(bytes).filter(Signed::is_intact)?;
                let length = signed.length();
                bytes.truncate(length);
                Some(0)
            }
            State::Unwritten | State::Begun => None,
        };
        Some(Stored { slot, sequence: sequence? })
    }

    /// Stores a calibration, in the slot that is not `kept` or, if none is, in the one that does not count.
    ///
    /// # Errors
    /// A [`StorageError`]; what counted before counts still.
    pub fn commit(&mut self, bytes: &[u8], kept: Option<Slot>) -> Result<Stored, StorageError<F::Error>> {
        let slot = kept.map_or_else(|| self.newest_first()[1], Slot::other);
        let sequence = [slot, slot.other()].map(|slot| self.heading(slot).sequence(slot).unwrap_or(0));
        let sequence = sequence.into_iter().fold(0, u32::max).saturating_add(1);
        let erases = self.erase(slot)?;
        for (index, piece) in bytes.chunks(PIECE).enumerate() {
            let mut padded = [0xFF; PIECE];
            padded.iter_mut().zip(piece).for_each(|(slot, byte)| *slot = *byte);
            self.write(slot, (index * PIECE) as u32, padded)?;
        }
        let record = Record { sequence, length: bytes.len(), checksum: crc32(bytes) };
        let [low, high] = record.to_bytes(erases);
        self.write(slot, HEADING_AT + PIECE as u32, low)?;
        self.write(slot, HEADING_AT + 2 * PIECE as u32, high)?;
        Ok(Stored { slot, sequence })
    }

    /// Makes a slot hold nothing.
    ///
    /// # Errors
    /// A [`StorageError`].
    pub fn clear(&mut self, slot: Slot) -> Result<(), StorageError<F::Error>> {
        self.erase(slot).map(drop)
    }

    /// Erases a slot, counts that, and marks it as begun: from then on it can't be taken for a programmer's.
    fn erase(&mut self, slot: Slot) -> Result<[u32; 2], StorageError<F::Error>> {
        let [first, second] = self.erases();
        let erases = match slot {
            Slot::First => [first.saturating_add(1), second],
            Slot::Second => [first, second.saturating_add(1)],
        };
        let begin = self.origin(slot);
        self.flash.erase(begin, begin.saturating_add(self.slot_bytes))?;
        self.write(slot, HEADING_AT, Mark { erases }.to_bytes())?;
        Ok(erases)
    }

    fn write(&mut self, slot: Slot, at: u32, bytes: [u8; PIECE]) -> Result<(), StorageError<F::Error>> {
        let at = self.origin(slot).saturating_add(at);
        self.flash.write(at, &bytes)?;
        let mut taken = [0; PIECE];
        self.flash.read(at, &mut taken)?;
        if taken == bytes { Ok(()) } else { Err(StorageError::NotTaken) }
    }

    fn fill(&mut self, slot: Slot, bytes: &mut Bytes, length: usize) -> Option<()> {
        bytes.clear();
        bytes.resize(length, 0).ok()?;
        self.flash.read(self.origin(slot), bytes).ok()
    }

    fn heading(&mut self, slot: Slot) -> Heading {
        let mut bytes = [0; HEADING];
        match self.flash.read(self.origin(slot).saturating_add(HEADING_AT), &mut bytes) {
            Ok(()) => Heading::from_bytes(&bytes),
            Err(_) => Heading::UNREADABLE,
        }
    }

    const fn origin(&self, slot: Slot) -> u32 {
        slot.of([0, self.slot_bytes])
    }
}

/// What a programmer must leave in a slot that shall hold nothing, and at which byte of it.
#[must_use]
pub fn empty_slot() -> (u32, [u8; 16]) {
    (HEADING_AT, Mark { erases: [0, 0] }.to_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_used_of_a_slot_ends_with_a_mark_and_a_record_of_two_pieces() {
        let (at, mark) = empty_slot();
        assert_eq!(SLOT_USED as usize, at as usize + 3 * mark.len());
    }
}
