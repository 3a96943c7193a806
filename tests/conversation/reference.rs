//! What the instrument is, as simply as it can be said: which calibration lies where, what was written so far, whether
//! the lock is open, what is streamed. It shares the evaluator with the instrument, and nothing of its conversation.

use crate::pool::{Calibration, Pool};
use firmware_core::Compensator;
use protocol::limits::{MAX_CHUNK, MAX_STORED};
use protocol::{Blob, Identity, InstrumentState, Reading, Refusal, Request, Response, Sample, Source, Status};
use protocol::{StorageState, Streamed, unlock_answer};
use std::collections::BTreeSet;
use tests::example;

/// How a calibration lies in a slot.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    pub bytes: Vec<u8>,
    /// 0 is a programmer's.
    pub sequence: u32,
}

struct InUse {
    bytes: Vec<u8>,
    provenance: [u8; 8],
    compensator: Compensator,
    /// Whether the next power-on finds it.
    stored: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lock {
    Locked,
    Challenged { nonce: u64, since_us: u64 },
    Open { since_us: u64 },
}

#[derive(Clone, Copy, Debug)]
pub struct Stream {
    pub what: Streamed,
    pub sequence: u16,
    pub period_us: u64,
    pub began_us: u64,
    pub next: u32,
    pub last_us: Option<u64>,
}

pub struct Reference<'a> {
    pool: &'a Pool,
    pub slots: [Option<Kept>; 2],
    pub erases: [u32; 2],
    pub read_only: bool,
    in_use: Option<InUse>,
    /// The slot that the next power-on will use.
    pub stored: Option<usize>,
    pub incoming: Vec<u8>,
    pub lock: Lock,
    pub stream: Option<Stream>,
    nonces: BTreeSet<u64>,
    readings: u32,
    raised: Status,
}

impl<'a> Reference<'a> {
    /// After power-on, with this in flash.
    pub fn powered(pool: &'a Pool, slots: [Option<Kept>; 2], erases: [u32; 2], read_only: bool) -> Self {
        let mut reference = Self {
            pool,
            slots,
            erases,
            read_only,
            in_use: None,
            stored: None,
            incoming: Vec::new(),
            lock: Lock::Locked,
            stream: None,
            nonces: BTreeSet::new(),
            readings: 0,
            raised: Status::empty(),
        };
        let usable = |slot: &usize| reference.usable(*slot).is_some();
        let sequence = |slot: &usize| reference.slots[*slot].as_ref().map(|kept| kept.sequence);
        if let Some(slot) = [0, 1].into_iter().filter(usable).max_by_key(sequence) {
            reference.use_stored(slot);
        }
        reference
    }

    /// Power was away.
    pub fn power_cycled(&mut self) {
        *self = Self::powered(self.pool, self.slots.clone(), self.erases, self.read_only);
    }

    /// What the instrument must answer. What only it can know, a nonce and a sample, is taken from what it gave.
    pub fn answer(&mut self, request: &Request, sequence: u16, time_us: u64, given: &Response) -> Response {
        self.carried_out(request, sequence, time_us, given).unwrap_or_else(Response::Refused)
    }

    fn carried_out(&mut self, request: &Request, sequence: u16, time_us: u64, given: &Response) -> Answer {
        match request {
            Request::Identify => return Ok(Response::Identity(identity())),
            Request::ReadState => return Ok(Response::State(self.state())),
            Request::Measure => {
                let Response::Measured { sample, .. } = given else { panic!("measured {given:?}") };
                assert_eq!((sample.time_us, sample.channels), (time_us, [Sample::NOT_MEASURED; 8]));
                return Ok(Response::Measured { sample: *sample, reading: self.reading(sample) });
            }
            Request::Restart => {
                if let Some(in_use) = &mut self.in_use {
                    in_use.compensator.restart();
                }
            }
            Request::Replay(sample) => return Ok(Response::Reading(self.reading(sample))),
            Request::WriteBlob { offset, bytes } => self.write(usize::from(*offset), bytes, time_us)?,
            Request::CommitBlob { length } => return self.commit(usize::from(*length), time_us, given),
            Request::ReadBlob { offset } => return self.piece(*offset),
            Request::ReadStorage => return Ok(Response::Storage(self.storage())),
            Request::Challenge => {
                let Response::Nonce { nonce } = *given else { panic!("challenged {given:?}") };
                assert!(self.nonces.insert(nonce), "the same nonce twice");
                self.lock = Lock::Challenged { nonce, since_us: time_us };
                return Ok(Response::Nonce { nonce });
            }
            Request::Unlock { answer } => self.unlock(*answer, time_us)?,
            Request::RollBack => self.roll_back(time_us)?,
            Request::Stream { what, period_ms } => self.begin_stream(*what, *period_ms, sequence, time_us)?,
            Request::Stop => self.stream = None,
            other => panic!("{other:?} is new here"),
        }
        Ok(Response::Done)
    }

    /// The reading of a sample by the calibration in use.
    pub fn reading(&mut self, sample: &Sample) -> Reading {
        let reading = match &mut self.in_use {
            Some(in_use) => in_use.compensator.compensate(sample),
            None => Reading::none(sample.time_us, sample.faults | Status::UNCALIBRATED),
        };
        self.readings += 1;
        self.raised |= reading.status;
        reading
    }

    fn state(&self) -> InstrumentState {
        let provenance = self.in_use.as_ref().map(|in_use| in_use.provenance);
        InstrumentState { provenance, readings: self.readings, raised: self.raised }
    }

    fn is_open(&self, time_us: u64) -> bool {
        matches!(self.lock, Lock::Open { since_us } if (since_us..since_us + 300_000_000).contains(&time_us))
    }

    fn unlock(&mut self, answer: u32, time_us: u64) -> Result<(), Refusal> {
        match std::mem::replace(&mut self.lock, Lock::Locked) {
            Lock::Challenged { nonce, since_us }
                if answer == unlock_answer(nonce, example::SERIAL)
                    && (since_us..since_us + 60_000_000).contains(&time_us) =>
            {
                self.lock = Lock::Open { since_us: time_us };
                self.incoming.clear();
                Ok(())
            }
            _ => Err(Refusal::WrongAnswer),
        }
    }

    /// An unlock serves once, whatever comes of it.
    fn use_unlock(&mut self, time_us: u64) -> Result<(), Refusal> {
        let open = self.is_open(time_us);
        self.lock = Lock::Locked;
        if open { Ok(()) } else { Err(Refusal::Locked) }
    }

    fn write(&mut self, offset: usize, bytes: &[u8], time_us: u64) -> Result<(), Refusal> {
        if !self.is_open(time_us) {
            return Err(Refusal::Locked);
        }
        if offset > self.incoming.len() {
            return Err(Refusal::Offset(self.incoming.len() as u16));
        }
        if offset + bytes.len() > MAX_STORED {
            return Err(Refusal::Unusable);
        }
        self.incoming.truncate(offset);
        self.incoming.extend(bytes);
        Ok(())
    }

    fn commit(&mut self, length: usize, time_us: u64, given: &Response) -> Answer {
        self.use_unlock(time_us)?;
        let bytes = self.incoming.get(..length).ok_or(Refusal::Truncated)?.to_vec();
        let calibration = match self.pool.verdict(&bytes) {
            Ok(calibration) => calibration,
            Err(Some(refusal)) => return Err(refusal),
            // Nonsense, of which only so much is certain: it is refused.
            Err(None) => match given {
                Response::Refused(refusal) if *refusal != Refusal::Locked => return Err(*refusal),
                _ => panic!("nonsense was taken: {given:?}"),
            },
        };
        self.incoming.clear();
        if !self.read_only {
            let slot = self.stored.map_or(1, |slot| 1 - slot);
            let newest = self.slots.iter().flatten().map(|kept| kept.sequence).max().unwrap_or(0);
            self.slots[slot] = Some(Kept { bytes: bytes.clone(), sequence: newest + 1 });
            self.erases[slot] += 1;
            self.stored = Some(slot);
        }
        self.put_to_use(bytes, calibration, !self.read_only);
        Ok(if self.read_only { Response::UntilPowerOff } else { Response::Done })
    }

    fn roll_back(&mut self, time_us: u64) -> Result<(), Refusal> {
        self.use_unlock(time_us)?;
        let slot = self.stored.ok_or(Refusal::NothingBefore)?;
        if self.in_use.as_ref().is_some_and(|in_use| !in_use.stored) {
            self.use_stored(slot);
            return Ok(());
        }
        if self.usable(1 - slot).is_none() {
            return Err(Refusal::NothingBefore);
        }
        if self.read_only {
            return Err(Refusal::StorageFailed);
        }
        self.slots[slot] = None;
        self.erases[slot] += 1;
        self.use_stored(1 - slot);
        Ok(())
    }

    fn piece(&self, offset: u16) -> Answer {
        let bytes = &self.in_use.as_ref().ok_or(Refusal::NoCalibration)?.bytes;
        let length = bytes.len() as u16;
        let rest = bytes.get(usize::from(offset)..).ok_or(Refusal::Offset(length))?;
        let piece = &rest[..rest.len().min(MAX_CHUNK)];
        Ok(Response::Piece { offset, length, bytes: piece.try_into().expect("a piece") })
    }

    fn storage(&mut self) -> StorageState {
        let sequence = self.stored.and_then(|slot| self.slots[slot].as_ref()).map_or(0, |kept| kept.sequence);
        let before = self.stored.is_some_and(|slot| self.usable(1 - slot).is_some());
        let (source, can_roll_back) = match &self.in_use {
            None => (Source::Nothing, before),
            Some(in_use) if !in_use.stored => (Source::UntilPowerOff, self.stored.is_some()),
            Some(_) if sequence == 0 => (Source::Factory, before),
            Some(_) => (Source::Committed, before),
        };
        // To look at the other slot takes the memory in which a new calibration is written down.
        if source != Source::UntilPowerOff && self.stored.is_some() {
            self.incoming.clear();
        }
        StorageState { source, sequence, can_roll_back, erases: self.erases, key: self.pool.key_shown() }
    }

    fn begin_stream(&mut self, what: Streamed, period_ms: u32, sequence: u16, time_us: u64) -> Result<(), Refusal> {
        let (shortest_ms, longest_ms) = (10, 3_600_000);
        if period_ms < shortest_ms || period_ms > longest_ms {
            return Err(Refusal::Period { shortest_ms, longest_ms });
        }
        let period_us = u64::from(period_ms) * 1000;
        self.stream = Some(Stream { what, sequence, period_us, began_us: time_us, next: 0, last_us: None });
        Ok(())
    }

    fn usable(&self, slot: usize) -> Option<&'a Calibration> {
        self.slots[slot].as_ref().and_then(|kept| self.pool.verdict(&kept.bytes).ok())
    }

    fn use_stored(&mut self, slot: usize) {
        let calibration = self.usable(slot).expect("a usable one");
        let bytes = self.slots[slot].as_ref().expect("what is usable is there").bytes.clone();
        self.stored = Some(slot);
        self.put_to_use(bytes, calibration, true);
    }

    fn put_to_use(&mut self, bytes: Vec<u8>, calibration: &Calibration, stored: bool) {
        let compensator = Compensator::load(&calibration.blob).expect("the pool says that it runs");
        self.in_use = Some(InUse { bytes, provenance: calibration.blob.provenance, compensator, stored });
    }
}

type Answer = Result<Response, Refusal>;

fn identity() -> Identity {
    let serial = example::SERIAL.try_into().expect("a short name");
    Identity { serial, blob_layout: Blob::LAYOUT, effects: 22 }
}
