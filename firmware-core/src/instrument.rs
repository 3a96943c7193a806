//! The conversation: bytes in, bytes out. No I/O of its own and no clock: both are arguments.

use crate::calibrations::Calibrations;
use crate::effect;
use crate::identity::IdentityRecord;
use crate::lock::Lock;
use crate::log;
use crate::sensors::Sensors;
use crate::storage::Storage;
use crate::stream::Stream;
use embedded_hal::i2c::I2c;
use embedded_hal::spi::SpiDevice;
use embedded_storage::nor_flash::NorFlash;
use protocol::{
    Blob, Decoder, Envelope, FrameError, Identity, InstrumentState, Line, Reading, Refusal, Request, Response, Sample,
    Status, Streamed, encode_response,
};

/// Half of the shortest period of a stream.
const LOOK_EVERY_US: u32 = 5_000;

/// An instrument: sensors, calibrations, and a conversation about both.
pub struct Instrument<SPI, I2C, F> {
    sensors: Sensors<SPI, I2C>,
    calibrations: Calibrations<F>,
    lock: Lock,
    stream: Option<Stream>,
    decoder: Decoder,
    answered: u16,
    answer: Line,
    unasked: Line,
    readings: u32,
    raised: Status,
}

impl<SPI: SpiDevice, I2C: I2c, F: NorFlash> Instrument<SPI, I2C, F> {
    /// An instrument as after power-on, with the newest of the stored calibrations that it can use. Without one
    /// it measures all the same, and every reading says so.
    pub fn start(sensors: Sensors<SPI, I2C>, identity: IdentityRecord, storage: Storage<F>) -> Self {
        Self {
            sensors,
            calibrations: Calibrations::start(identity, storage),
            lock: Lock::new(),
            stream: None,
            decoder: Decoder::new(),
            answered: 0,
            answer: Line::new(),
            unasked: Line::new(),
            readings: 0,
            raised: Status::empty(),
        }
    }

    /// The sensors, for whoever owns the hardware.
    pub const fn sensors_mut(&mut self) -> &mut Sensors<SPI, I2C> {
        &mut self.sensors
    }

    /// The storage, for whoever owns the hardware.
    pub const fn storage_mut(&mut self) -> &mut Storage<F> {
        self.calibrations.storage_mut()
    }

    /// Takes one byte from the line; at the end of a request returns the answer's bytes.
    /// Broken frames get no answer: the host repeats what was not answered. A repeated request gets
    /// the first answer again and is not carried out twice, or a lost answer would advance the memories.
    pub fn receive(&mut self, byte: u8, time_us: u64) -> Option<&[u8]> {
        let (sequence, request) = match self.decoder.push(byte)? {
            Ok(Envelope { sequence, body }) => (sequence, Some(body)),
            Err(FrameError::UnknownMessage { sequence }) => (sequence, None),
            Err(_) => return None,
        };
        if sequence == 0 {
            // A conversation begins: nobody listens to the stream of the one before.
            self.stream = None;
        }
        if sequence == 0 || sequence != self.answered {
            let body = match request {
                Some(request) => self.answer(request, sequence, time_us).unwrap_or_else(Response::Refused),
                None => Response::Refused(Refusal::UnknownRequest),
            };
            self.answer = encode_response(&Envelope { sequence, body }).ok()?;
            self.answered = sequence;
        }
        Some(&self.answer)
    }

    /// What a stream has to say at this time, unasked.
    pub fn poll(&mut self, time_us: u64) -> Option<&[u8]> {
        let stream = self.stream.as_mut().filter(|stream| stream.is_due(time_us))?;
        let sample = self.sensors.sample(time_us);
        if sample.faults.contains(Status::STALE) && stream.waits(time_us) {
            return None;
        }
        let (what, sequence, number) = (stream.what, stream.sequence, stream.take(time_us));
        let reading = self.compensate(&sample);
        let body = match what {
            Streamed::Readings => Response::StreamedReading { number, reading },
            Streamed::Samples => Response::StreamedSample { number, sample },
        };
        self.unasked = encode_response(&Envelope { sequence, body }).ok()?;
        Some(&self.unasked)
    }

    /// How often a stream wants to be polled, µs; `None` while there is none.
    pub const fn wake_every_us(&self) -> Option<u32> {
        if self.stream.is_some() { Some(LOOK_EVERY_US) } else { None }
    }

    fn answer(&mut self, request: Request, sequence: u16, time_us: u64) -> Result<Response, Refusal> {
        match request {
            Request::Identify => return Ok(Response::Identity(self.identity())),
            Request::ReadState => return Ok(Response::State(self.state())),
            Request::Measure => {
                let sample = self.sensors.sample(time_us);
                return Ok(Response::Measured { sample, reading: self.compensate(&sample) });
            }
            Request::Restart => {
                if let Some(compensator) = self.calibrations.compensator_mut() {
                    compensator.restart();
                }
            }
            Request::Replay(sample) => return Ok(Response::Reading(self.compensate(&sample))),
            Request::Stream { what, period_ms } => {
                self.stream = Some(Stream::new(what, period_ms, sequence, time_us)?);
            }
            Request::Stop => self.stream = None,
            Request::ReadBlob { offset } => return self.calibrations.piece(offset),
            Request::ReadStorage => return Ok(Response::Storage(self.calibrations.state())),
            Request::Challenge => return Ok(Response::Nonce { nonce: self.lock.challenge(time_us) }),
            Request::Unlock { answer } => {
                self.lock.answer(answer, &self.calibrations.identity().serial, time_us)?;
                self.calibrations.forget();
            }
            Request::WriteBlob { offset, bytes } => {
                self.lock.check(time_us)?;
                self.calibrations.write(usize::from(offset), &bytes)?;
            }
            Request::CommitBlob { length } => {
                self.use_unlock(time_us)?;
                return self.calibrations.commit(usize::from(length));
            }
            Request::RollBack => {
                self.use_unlock(time_us)?;
                self.calibrations.roll_back()?;
            }
            _ => return Err(Refusal::UnknownRequest),
        }
        Ok(Response::Done)
    }

    /// An unlock serves once.
    fn use_unlock(&mut self, time_us: u64) -> Result<(), Refusal> {
        let allowed = self.lock.check(time_us);
        self.lock.close();
        allowed
    }

    fn identity(&self) -> Identity {
        let serial = self.calibrations.identity().serial.clone();
        Identity { serial, blob_layout: Blob::LAYOUT, effects: effect::HIGHEST }
    }

    fn state(&self) -> InstrumentState {
        InstrumentState { provenance: self.calibrations.provenance(), readings: self.readings, raised: self.raised }
    }

    fn compensate(&mut self, sample: &Sample) -> Reading {
        let reading = match self.calibrations.compensator_mut() {
            Some(compensator) => compensator.compensate(sample),
            None => Reading::none(sample.time_us, sample.faults | Status::UNCALIBRATED),
        };
        self.readings = self.readings.wrapping_add(1);
        log::raised(reading.status.difference(self.raised));
        self.raised |= reading.status;
        reading
    }
}
