//! What can go wrong between a bus and a part, and the error that a driver then sees.

use core::fmt;
use embedded_hal::i2c::NoAcknowledgeSource;
use embedded_hal::{i2c, spi};

/// How a virtual part misbehaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartFault {
    /// Not at all.
    #[default]
    None,
    /// Nobody answers: no acknowledge on I²C, all ones on SPI.
    Absent,
    /// The part answers and never converts or counts again.
    Stuck,
    /// The bus fails for good after so many more bytes.
    BusFailsAfter(usize),
    /// Another part answers with this identification.
    OtherPart(u16),
}

impl PartFault {
    /// Counts one byte on the bus.
    pub(crate) const fn pass_byte(&mut self) -> Result<(), BusError> {
        match self {
            Self::BusFailsAfter(0) => Err(BusError::Failed),
            Self::BusFailsAfter(left) => {
                *left -= 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

/// Why a transfer on a virtual bus failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusError {
    /// Nobody acknowledged the address.
    NoAcknowledge,
    /// The bus broke during the transfer.
    Failed,
}

impl fmt::Display for BusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoAcknowledge => "nobody acknowledged the address",
            Self::Failed => "the bus failed during the transfer",
        })
    }
}

impl core::error::Error for BusError {}

impl i2c::Error for BusError {
    fn kind(&self) -> i2c::ErrorKind {
        match self {
            Self::NoAcknowledge => i2c::ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            Self::Failed => i2c::ErrorKind::Bus,
        }
    }
}

impl spi::Error for BusError {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}
