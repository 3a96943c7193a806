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

#[cfg(test)]
mod tests {
    use super::*;
    use core::convert::Infallible;
    use embedded_hal::{i2c, spi};

    /// A part of which only the registers are there, so many bytes each.
    struct Registers([u8; 20], usize);

    impl Registers {
        fn show(&self, register: u8, bytes: &mut [u8]) {
            let from = usize::from(register) * self.1;
            bytes.copy_from_slice(&self.0[from..from + bytes.len()]);
        }
    }

    impl spi::ErrorType for Registers {
        type Error = Infallible;
    }

    impl SpiDevice for Registers {
        fn transaction(&mut self, operations: &mut [spi::Operation<'_, u8>]) -> Result<(), Infallible> {
            let [spi::Operation::Write(register), spi::Operation::Read(bytes)] = operations else {
                panic!("no reading")
            };
            self.show(register[0], bytes);
            Ok(())
        }
    }

    impl i2c::ErrorType for Registers {
        type Error = Infallible;
    }

    impl I2c for Registers {
        fn transaction(&mut self, _: u8, operations: &mut [i2c::Operation<'_>]) -> Result<(), Infallible> {
            let [i2c::Operation::Write(register), i2c::Operation::Read(bytes)] = operations else {
                panic!("no reading")
            };
            self.show(register[0], bytes);
            Ok(())
        }
    }

    /// With a reference of 100 MHz; cycles and ticks of each resonator, 25 °C.
    fn sample(measured: bool, counts: [u32; 4]) -> Sample {
        let mut of_counter = [0; 20];
        of_counter[3] = u8::from(measured);
        of_counter[4..].copy_from_slice(counts.map(u32::to_be_bytes).as_flattened());
        let mut of_thermometer = [0; 20];
        of_thermometer[..4].copy_from_slice(&[0x0C, 0x80, if measured { 0x20 } else { 0 }, 0]);
        let counter = Counter::new(Registers(of_counter, 1), 100_000_000);
        let thermometer = Thermometer::new(Registers(of_thermometer, 2), 0x48);
        Sensors { counter, thermometer }.sample(7)
    }

    #[test]
    fn what_has_measured_nothing_yet_is_stale_in_both_its_parts() {
        let expected = Status::RESONATOR_FAULT | Status::THERMOMETER_FAULT | Status::STALE;
        assert_eq!(sample(false, [4, 5, 4, 5]).faults, expected);
    }

    #[test]
    fn a_resonator_may_be_as_fast_as_the_reference_and_no_faster() {
        let found = sample(true, [5, 5, 4, 5]);
        let expected = Sample::from_pair(7, 100_000_000_000_000, 80_000_000_000_000, 25_000_000);
        assert_eq!(found, expected);
        assert_eq!(sample(true, [6, 5, 4, 5]).faults, Status::RESONATOR_FAULT);
    }
}
