//! Both sensors at one instant: what they say, and what is wrong with them.

use crate::counter::{Counter, CounterError};
use crate::thermometer::{Thermometer, ThermometerError};
use embedded_hal::i2c::I2c;
use embedded_hal::spi::SpiDevice;
use protocol::{Sample, Status};

/// The two sensors of the instrument.
#[derive(Clone, Debug)]
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
        let (temperature_uc, temperature_fault) = match self.thermometer.temperature_uc(time_us) {
            Ok(temperature_uc) => (temperature_uc, Status::empty()),
            Err(ThermometerError::NotReady | ThermometerError::Stuck) => (0, Status::THERMOMETER_FAULT | Status::STALE),
            Err(_) => (0, Status::THERMOMETER_FAULT),
        };
        let mut sample = match pair {
            Some(pair) => Sample::from_pair(time_us, pair.f1_uhz, pair.f2_uhz, temperature_uc),
            None => Sample::from_difference(time_us, 0, temperature_uc),
        };
        // Nothing here measures a channel yet; a calibration that needs one flags it.
        sample.faults = frequency_fault | temperature_fault;
        sample
    }
}
