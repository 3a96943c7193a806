//! The calibration in use, the one that a host is writing, and the ones in flash.
//!
//! Bytes become a calibration in one place, [`check`], whether they come from flash or over the wire.

use crate::compensator::Compensator;
use crate::identity::{FactoryKey, IdentityRecord};
use crate::log;
use crate::signature;
use crate::storage::{Bytes, Slot, Storage, Stored};
use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use protocol::limits::MAX_CHUNK;
use protocol::{Blob, Refusal, Response, Source, StorageState};

/// All calibrations of an instrument.
pub struct Calibrations<F> {
    identity: IdentityRecord,
    storage: Storage<F>,
    in_use: Option<Calibration>,
    /// Where the one lies that the next power-on will find.
    stored: Option<Stored>,
    incoming: Bytes,
}

/// A checked calibration.
struct Calibration {
    compensator: Compensator,
    provenance: [u8; 8],
    bytes: Bytes,
    /// Whether it is the stored one.
    stored: bool,
}

impl<F: NorFlash> Calibrations<F> {
    /// The newest stored calibration that this instrument can use, or none.
    pub fn start(identity: IdentityRecord, storage: Storage<F>) -> Self {
        let mut all = Self { identity, storage, in_use: None, stored: None, incoming: Bytes::new() };
        for slot in all.storage.newest_first() {
            if all.use_stored(slot).is_ok() {
                break;
            }
        }
        if all.in_use.is_none() {
            log::none_stored();
        }
        all.incoming.clear();
        all
    }

    /// Who the sensor is.
    pub const fn identity(&self) -> &IdentityRecord {
        &self.identity
    }

    /// The storage, for whoever owns the hardware.
    pub const fn storage_mut(&mut self) -> &mut Storage<F> {
        &mut self.storage
    }

    /// What evaluates the calibration in use.
    pub const fn compensator_mut(&mut self) -> Option<&mut Compensator> {
        match &mut self.in_use {
            Some(calibration) => Some(&mut calibration.compensator),
            None => None,
        }
    }

    /// Provenance of the calibration in use.
    pub fn provenance(&self) -> Option<[u8; 8]> {
        self.in_use.as_ref().map(|calibration| calibration.provenance)
    }

    /// Takes a piece of a new calibration.
    ///
    /// # Errors
    /// A [`Refusal`].
    pub fn write(&mut self, offset: usize, bytes: &[u8]) -> Result<(), Refusal> {
        // A repeated piece (its answer got lost) is taken again, a missing one is asked for.
        if offset > self.incoming.len() {
            return Err(Refusal::Offset(u16::try_from(self.incoming.len()).unwrap_or(u16::MAX)));
        }
        if offset.saturating_add(bytes.len()) > self.incoming.capacity() {
            return Err(Refusal::Unusable);
        }
        self.incoming.truncate(offset);
        self.incoming.extend_from_slice(bytes).map_err(|_| Refusal::Unusable)
    }

    /// Forgets the pieces that were written.
    pub fn forget(&mut self) {
        self.incoming.clear();
    }

    /// Checks what was written, stores it and uses it. The old one runs on unless it passes every check.
    ///
    /// # Errors
    /// A [`Refusal`].
    pub fn commit(&mut self, length: usize) -> Result<Response, Refusal> {
        let bytes = self.incoming.get(..length).ok_or(Refusal::Truncated)?;
        let mut calibration = check(bytes, &self.identity)?;
        match self.storage.commit(bytes, self.stored.map(|stored| stored.slot)) {
            Ok(stored) => self.stored = Some(stored),
            Err(_) => calibration.stored = false,
        }
        let answer = if calibration.stored { Response::Done } else { Response::UntilPowerOff };
        self.put_to_use(calibration);
        self.incoming.clear();
        Ok(answer)
    }

    /// Returns to the calibration that was stored before the one in use.
    ///
    /// # Errors
    /// A [`Refusal`]; nothing has changed then.
    pub fn roll_back(&mut self) -> Result<(), Refusal> {
        let stored = self.stored.ok_or(Refusal::NothingBefore)?;
        if self.in_use.as_ref().is_some_and(|calibration| !calibration.stored) {
            return self.use_stored(stored.slot);
        }
        let other = stored.slot.other();
        self.look(other).map_err(|_| Refusal::NothingBefore)?;
        self.storage.clear(stored.slot).map_err(|_| Refusal::StorageFailed)?;
        self.use_stored(other)
    }

    /// A piece of the calibration in use.
    ///
    /// # Errors
    /// [`Refusal::NoCalibration`], or [`Refusal::Offset`] with its length beyond its end.
    pub fn piece(&self, offset: u16) -> Result<Response, Refusal> {
        let bytes = &self.in_use.as_ref().ok_or(Refusal::NoCalibration)?.bytes;
        let length = u16::try_from(bytes.len()).unwrap_or(u16::MAX);
        let rest = bytes.get(usize::from(offset)..).ok_or(Refusal::Offset(length))?;
        let piece = rest.get(..MAX_CHUNK).unwrap_or(rest);
        Ok(Response::Piece { offset, length, bytes: Vec::from_slice(piece).unwrap_or_default() })
    }

    /// What is stored.
    pub fn state(&mut self) -> StorageState {
        let sequence = self.stored.map_or(0, |stored| stored.sequence);
        let source = match &self.in_use {
            None => Source::Nothing,
            Some(calibration) if !calibration.stored => Source::UntilPowerOff,
            Some(_) if sequence == 0 => Source::Factory,
            Some(_) => Source::Committed,
        };
        let can_roll_back = match (source, self.stored) {
            (Source::UntilPowerOff, stored) => stored.is_some(),
            (_, Some(stored)) => self.look(stored.slot.other()).is_ok(),
            (_, None) => false,
        };
        let key = match &self.identity.key {
            FactoryKey::NotAsked => None,
            FactoryKey::Asked(key) => Some(key.first_chunk().copied().unwrap_or_default()),
            FactoryKey::Spoilt => Some([0; 8]),
        };
        StorageState { source, sequence, can_roll_back, erases: self.storage.erases(), key }
    }

    fn use_stored(&mut self, slot: Slot) -> Result<(), Refusal> {
        let (stored, calibration) = self.look(slot)?;
        self.stored = Some(stored);
        self.put_to_use(calibration);
        Ok(())
    }

    fn put_to_use(&mut self, calibration: Calibration) {
        log::in_use(calibration.provenance);
        self.in_use = Some(calibration);
    }

    /// The calibration in a slot, if it is whole and passes every check. Takes the place of what was being written.
    fn look(&mut self, slot: Slot) -> Result<(Stored, Calibration), Refusal> {
        let read = self.storage.read(slot, &mut self.incoming).ok_or(Refusal::NoCalibration);
        let found = read.and_then(|stored| Ok((stored, check(&self.incoming, &self.identity)?)));
        // Also where nothing sound was read: else that would count as written by the host.
        self.incoming.clear();
        found
    }
}

fn check(bytes: &[u8], identity: &IdentityRecord) -> Result<Calibration, Refusal> {
    let blob = Blob::from_bytes(bytes).inspect_err(log::no_calibration)?;
    if !blob.serial.is_empty() && blob.serial != identity.serial {
        log::foreign();
        return Err(Refusal::OtherSerial);
    }
    signature::check(bytes, &identity.key)?;
    let compensator = Compensator::load(&blob).map_err(|_| Refusal::Unusable)?;
    let bytes = Bytes::from_slice(bytes).map_err(|_| Refusal::Unusable)?;
    Ok(Calibration { compensator, provenance: blob.provenance, bytes, stored: true })
}
