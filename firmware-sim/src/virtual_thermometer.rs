//! A TMP117 on a virtual I²C bus, at the level of its registers.
//!
//! Apart from the twin's thermometer: that one says what a thermometer would show, this one how the
//! part says it. After the Texas Instruments data sheet SNOSD82: a write sets the register pointer,
//! a read gives the register at the pointer, high byte first, and does not move the pointer.

use crate::virtual_fault::{BusError, PartFault};
use embedded_hal::i2c::{ErrorType, I2c, Operation, SevenBitAddress};

const TEMPERATURE: u8 = 0x00;
const CONFIGURATION: u8 = 0x01;
const DEVICE_ID: u8 = 0x0F;
const ID: u16 = 0x0117;
/// −256 °C, which the part reads from power-on until its first conversion.
const BEFORE_FIRST_CONVERSION: i16 = i16::MIN;
const CONFIGURATION_AT_RESET: u16 = 0x0220;
const DATA_READY: u16 = 1 << 13;
/// Two steps of 7.8125 m°C, µ°C.
const TWO_STEPS_UC: i64 = 15_625;

/// A TMP117 on an I²C bus of its own.
#[derive(Clone, Debug)]
pub struct VirtualThermometer {
    /// How it misbehaves.
    pub fault: PartFault,
    address: SevenBitAddress,
    pointer: u8,
    temperature: i16,
    data_ready: bool,
}

impl VirtualThermometer {
    /// A part that was just powered at `address` and has not converted yet.
    #[must_use]
    pub const fn new(address: SevenBitAddress) -> Self {
        Self {
            fault: PartFault::None,
            address,
            pointer: TEMPERATURE,
            temperature: BEFORE_FIRST_CONVERSION,
            data_ready: false,
        }
    }

    /// Converts once, to the nearest step within the register's ±256 °C.
    pub fn convert(&mut self, temperature_uc: i32) {
        if self.fault == PartFault::Stuck {
            return;
        }
        let doubled = 2 * i64::from(temperature_uc);
        let half = doubled.signum() * (TWO_STEPS_UC / 2);
        let steps = (doubled + half) / TWO_STEPS_UC;
        self.temperature = i16::try_from(steps).unwrap_or(if steps < 0 { i16::MIN } else { i16::MAX });
        self.data_ready = true;
    }

    /// Puts any bits into the temperature register, as no conversion would, and says that one ended.
    pub const fn force_register(&mut self, bits: u16) {
        self.temperature = bits.cast_signed();
        self.data_ready = true;
    }

    fn register(&mut self) -> u16 {
        match self.pointer {
            TEMPERATURE => {
                self.data_ready = false;
                self.temperature.cast_unsigned()
            }
            CONFIGURATION => {
                let ready = std::mem::take(&mut self.data_ready);
                CONFIGURATION_AT_RESET | if ready { DATA_READY } else { 0 }
            }
            DEVICE_ID => match self.fault {
                PartFault::OtherPart(id) => id,
                _ => ID,
            },
            _ => 0,
        }
    }

    fn perform(&mut self, operation: &mut Operation<'_>) -> Result<(), BusError> {
        match operation {
            Operation::Write(bytes) => {
                for (i, byte) in bytes.iter().enumerate() {
                    self.fault.pass_byte()?;
                    // The driver configures nothing, so only the pointer is modelled.
                    if i == 0 {
                        self.pointer = *byte;
                    }
                }
            }
            Operation::Read(bytes) => {
                let value = self.register().to_be_bytes();
                for (slot, byte) in bytes.iter_mut().zip(value.into_iter().cycle()) {
                    self.fault.pass_byte()?;
                    *slot = byte;
                }
            }
        }
        Ok(())
    }
}

impl ErrorType for VirtualThermometer {
    type Error = BusError;
}

impl I2c for VirtualThermometer {
    fn transaction(&mut self, address: SevenBitAddress, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        self.fault.pass_byte()?;
        if address != self.address || self.fault == PartFault::Absent {
            return Err(BusError::NoAcknowledge);
        }
        operations.iter_mut().try_for_each(|operation| self.perform(operation))
    }
}
