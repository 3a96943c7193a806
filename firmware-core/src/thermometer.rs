//! Driver of the TMP117 digital thermometer.
//!
//! Registers after the Texas Instruments data sheet SNOSD82: temperature at 0x00 in steps of
//! 7.8125 m°C, device identification 0x0117 at 0x0F. The part reads −256 °C until its first conversion.

use embedded_hal::i2c::{I2c, SevenBitAddress};

const TEMPERATURE: u8 = 0x00;
const DEVICE_ID: u8 = 0x0F;
const ID: u16 = 0x0117;
const ID_MASK: u16 = 0x0FFF;
const NOT_YET_CONVERTED: i16 = i16::MIN;
const RANGE_UC: core::ops::RangeInclusive<i32> = -60_000_000..=155_000_000;

/// A TMP117 on an I²C bus.
#[derive(Debug)]
pub struct Thermometer<I2C> {
    bus: I2C,
    address: SevenBitAddress,
}

/// Why there is no temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThermometerError<E> {
    /// The bus failed.
    Bus(E),
    /// Another part answers at this address.
    WrongPart(u16),
    /// The part has not converted yet.
    NotReady,
    /// The value is outside −60 … 155 °C, which the part can't measure.
    Impossible {
        /// The value read, µ°C.
        temperature_uc: i32,
    },
}

impl<I2C: I2c> Thermometer<I2C> {
    /// The part's address with its ADD0 pin at ground.
    pub const ADDRESS: SevenBitAddress = 0x48;

    /// A thermometer at `address`.
    pub const fn new(bus: I2C, address: SevenBitAddress) -> Self {
        Self { bus, address }
    }

    /// The bus, for whoever owns the hardware.
    pub const fn bus_mut(&mut self) -> &mut I2C {
        &mut self.bus
    }

    /// Asks the part who it is.
    ///
    /// # Errors
    /// [`ThermometerError::WrongPart`] or a bus error.
    pub fn check(&mut self) -> Result<(), ThermometerError<I2C::Error>> {
        match self.read(DEVICE_ID)? & ID_MASK {
            ID => Ok(()),
            other => Err(ThermometerError::WrongPart(other)),
        }
    }

    /// The latest conversion, µ°C.
    ///
    /// # Errors
    /// Says why there is none.
    pub fn temperature_uc(&mut self) -> Result<i32, ThermometerError<I2C::Error>> {
        let steps = self.read(TEMPERATURE)?.cast_signed();
        if steps == NOT_YET_CONVERTED {
            return Err(ThermometerError::NotReady);
        }
        // One step is 7812.5 µ°C.
        let temperature_uc = i32::from(steps) * 15_625 / 2;
        if RANGE_UC.contains(&temperature_uc) {
            Ok(temperature_uc)
        } else {
            Err(ThermometerError::Impossible { temperature_uc })
        }
    }

    fn read(&mut self, register: u8) -> Result<u16, ThermometerError<I2C::Error>> {
        let mut bytes = [0; 2];
        self.bus.write_read(self.address, &[register], &mut bytes).map_err(ThermometerError::Bus)?;
        Ok(u16::from_be_bytes(bytes))
    }
}
