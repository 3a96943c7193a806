//! The conversation: bytes in, bytes out. No I/O of its own and no clock: both are arguments.

use crate::compensator::Compensator;
use crate::counter::{Counter, CounterError};
use crate::effect;
use crate::log;
use crate::thermometer::{Thermometer, ThermometerError};
use embedded_hal::i2c::I2c;
use embedded_hal::spi::SpiDevice;
use heapless::{String, Vec};
use protocol::limits::{MAX_BLOB, MAX_CHANNELS, MAX_CHUNK, MAX_NAME};
use protocol::{
    Blob, Decoder, Envelope, FrameError, Identity, InstrumentState, Line, Reading, Refusal, Request, Response, Sample,
    Status, encode_response,
};

/// The two sensors of the instrument.
#[derive(Debug)]
pub struct Sensors<SPI, I2C> {
    /// Frequencies of the resonators.
    pub counter: Counter<SPI>,
    /// Temperature of the package.
    pub thermometer: Thermometer<I2C>,
}

impl<SPI: SpiDevice, I2C: I2c> Sensors<SPI, I2C> {
    /// One instant. A sensor that fails is a flag in the sample, never the end of measuring.
    pub fn sample(&mut self, time_us: u64) -> Sample {
        let (pair, frequency_fault) = match self.counter.frequencies() {
            Ok(pair) => (Some(pair), Status::empty()),
            Err(CounterError::NotReady) => (None, Status::RESONATOR_FAULT | Status::STALE),
            Err(_) => (None, Status::RESONATOR_FAULT),
        };
        let (temperature_uc, temperature_fault) = match self.thermometer.temperature_uc() {
            Ok(temperature_uc) => (temperature_uc, Status::empty()),
            Err(ThermometerError::NotReady) => (0, Status::THERMOMETER_FAULT | Status::STALE),
            Err(_) => (0, Status::THERMOMETER_FAULT),
        };
        let mut sample = match pair {
            Some(pair) => Sample::from_pair(time_us, pair.f1_uhz, pair.f2_uhz, temperature_uc),
            None => Sample::from_difference(time_us, 0, temperature_uc),
        };
        sample.faults = frequency_fault | temperature_fault;
        // Nothing here measures them yet; a calibration that needs one flags it.
        sample.channels = [Sample::NOT_MEASURED; MAX_CHANNELS];
        sample
    }
}

/// An instrument: sensors, a calibration, and a conversation about both.
pub struct Instrument<SPI, I2C> {
    sensors: Sensors<SPI, I2C>,
    serial: String<MAX_NAME>,
    calibration: Option<Calibration>,
    incoming: Vec<u8, MAX_BLOB>,
    decoder: Decoder,
    answered: u16,
    answer: Line,
    readings: u32,
    raised: Status,
}

struct Calibration {
    compensator: Compensator,
    provenance: [u8; 8],
}

impl<SPI: SpiDevice, I2C: I2c> Instrument<SPI, I2C> {
    /// An instrument that waits for its calibration.
    pub const fn new(sensors: Sensors<SPI, I2C>, serial: String<MAX_NAME>) -> Self {
        Self {
            sensors,
            serial,
            calibration: None,
            incoming: Vec::new(),
            decoder: Decoder::new(),
            answered: 0,
            answer: Line::new(),
            readings: 0,
            raised: Status::empty(),
        }
    }

    /// The sensors, for whoever owns the hardware.
    pub const fn sensors_mut(&mut self) -> &mut Sensors<SPI, I2C> {
        &mut self.sensors
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
        if sequence == 0 || sequence != self.answered {
            let body = match request {
                Some(request) => self.answer(request, time_us),
                None => Response::Refused(Refusal::UnknownRequest),
            };
            self.answer = encode_response(&Envelope { sequence, body }).ok()?;
            self.answered = sequence;
        }
        Some(&self.answer)
    }

    /// Uses a stored calibration from now on; the one in use runs on unless this passes every check.
    ///
    /// # Errors
    /// A [`Refusal`] that says why it can't be used.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), Refusal> {
        self.calibration = Some(check(bytes, &self.serial)?);
        Ok(())
    }

    /// The answer to one request.
    pub fn answer(&mut self, request: Request, time_us: u64) -> Response {
        match request {
            Request::Identify => Response::Identity(Identity {
                serial: self.serial.clone(),
                blob_layout: Blob::LAYOUT,
                effects: effect::HIGHEST,
            }),
            Request::ReadState => Response::State(self.state()),
            Request::Measure => {
                let sample = self.sensors.sample(time_us);
                Response::Measured { sample, reading: self.compensate(&sample) }
            }
            Request::Restart => {
                if let Some(calibration) = &mut self.calibration {
                    calibration.compensator.restart();
                }
                Response::Done
            }
            Request::Replay(sample) => Response::Reading(self.compensate(&sample)),
            Request::WriteBlob { offset, bytes } => self.write(usize::from(offset), &bytes),
            Request::CommitBlob { length } => self.commit(usize::from(length)),
            _ => Response::Refused(Refusal::UnknownRequest),
        }
    }

    fn state(&self) -> InstrumentState {
        InstrumentState {
            provenance: self.calibration.as_ref().map(|calibration| calibration.provenance),
            readings: self.readings,
            raised: self.raised,
        }
    }

    fn compensate(&mut self, sample: &Sample) -> Reading {
        let reading = match &mut self.calibration {
            Some(calibration) => calibration.compensator.compensate(sample),
            None => Reading::none(sample.time_us, sample.faults | Status::UNCALIBRATED),
        };
        self.readings = self.readings.wrapping_add(1);
        log::raised(reading.status.difference(self.raised));
        self.raised |= reading.status;
        reading
    }

    fn write(&mut self, offset: usize, bytes: &Vec<u8, MAX_CHUNK>) -> Response {
        if offset == 0 {
            self.incoming.clear();
        }
        // A repeated piece (its answer got lost) is taken again, a missing one is asked for.
        if offset > self.incoming.len() {
            return Response::Refused(Refusal::Offset(u16::try_from(self.incoming.len()).unwrap_or(u16::MAX)));
        }
        self.incoming.truncate(offset);
        match self.incoming.extend_from_slice(bytes) {
            Ok(()) => Response::Done,
            Err(_) => Response::Refused(Refusal::Unusable),
        }
    }

    /// The old calibration runs on unless the new one passes every check.
    fn commit(&mut self, length: usize) -> Response {
        let Some(bytes) = self.incoming.get(..length) else {
            return Response::Refused(Refusal::Truncated);
        };
        match check(bytes, &self.serial) {
            Ok(calibration) => {
                self.calibration = Some(calibration);
                Response::Done
            }
            Err(refusal) => Response::Refused(refusal),
        }
    }
}

fn check(bytes: &[u8], serial: &str) -> Result<Calibration, Refusal> {
    let blob = Blob::from_bytes(bytes).inspect_err(log::no_calibration)?;
    if !blob.serial.is_empty() && blob.serial != serial {
        log::foreign();
        return Err(Refusal::OtherSerial);
    }
    let compensator = Compensator::load(&blob).map_err(|_| Refusal::Unusable)?;
    Ok(Calibration { compensator, provenance: blob.provenance })
}
