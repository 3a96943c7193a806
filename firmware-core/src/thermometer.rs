//! Driver of the TMP117 digital thermometer.
//!
//! Registers after the Texas Instruments data sheet SNOSD82: temperature at 0x00 in steps of
//! 7.8125 m°C, device identification 0x0117 at 0x0F. The part reads −256 °C until its first conversion.
//!
//! A part that hangs goes on showing its last temperature, so a value alone proves nothing. Bit 13 of the
//! configuration at 0x01 says that a conversion ended since the last look; without one for
//! [`STUCK_AFTER_US`] there is no temperature.

use embedded_hal::i2c::{I2c, SevenBitAddress};

const TEMPERATURE: u8 = 0x00;
const CONFIGURATION: u8 = 0x01;
const DATA_READY: u16 = 1 << 13;
const DEVICE_ID: u8 = 0x0F;
const ID: u16 = 0x0117;
const ID_MASK: u16 = 0x0FFF;
const NOT_YET_CONVERTED: i16 = i16::MIN;
const RANGE_UC: core::ops::RangeInclusive<i32> = -60_000_000..=155_000_000;

/// The part converts once a second from power-on; this many go by before it counts as stuck, µs.
const STUCK_AFTER_US: u64 = 5_000_000;

/// A TMP117 on an I²C bus.
#[derive(Clone, Debug)]
pub struct Thermometer<I2C> {
    bus: I2C,
    address: SevenBitAddress,
    /// When a conversion was last seen, and what it gave.
    seen: Option<(u64, i32)>,
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
    /// The part answers and does not convert any more.
    Stuck,
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
        Self { bus, address, seen: None }
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
    pub fn temperature_uc(&mut self, time_us: u64) -> Result<i32, ThermometerError<I2C::Error>> {
        // Looking at the flag clears it, so it is looked at first: a conversion that ends in between is new next time.
        if self.read(CONFIGURATION)? & DATA_READY == 0 {
            return self.remembered(time_us);
        }
        let steps = self.read(TEMPERATURE)?.cast_signed();
        if steps == NOT_YET_CONVERTED {
            return Err(ThermometerError::NotReady);
        }
        // One step is 7812.5 µ°C.
        let temperature_uc = i32::from(steps) * 15_625 / 2;
        if !RANGE_UC.contains(&temperature_uc) {
            self.seen = None;
            return Err(ThermometerError::Impossible { temperature_uc });
        }
        self.seen = Some((time_us, temperature_uc));
        Ok(temperature_uc)
    }

    /// Between two conversions, the one before.
    const fn remembered(&self, time_us: u64) -> Result<i32, ThermometerError<I2C::Error>> {
        match self.seen {
            None => Err(ThermometerError::NotReady),
            Some((seen_us, _)) if time_us.saturating_sub(seen_us) > STUCK_AFTER_US => Err(ThermometerError::Stuck),
            Some((_, temperature_uc)) => Ok(temperature_uc),
        }
    }

    fn read(&mut self, register: u8) -> Result<u16, ThermometerError<I2C::Error>> {
        let mut bytes = [0; 2];
        self.bus.write_read(self.address, &[register], &mut bytes).map_err(ThermometerError::Bus)?;
        Ok(u16::from_be_bytes(bytes))
    }
}
