//! The bus to the thermometer: I²C at 100 kbit/s, this processor its only master.
//!
//! The sequences, reading one or two bytes included, are those of RM0090, section 27.3.3: what must
//! follow a byte has to be announced before it arrives.

use crate::clock::CLOCK_HZ;
use crate::registers::i2c1::{CCR, CR1, CR2, DR, SR1, SR2, TRISE};
use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation, SevenBitAddress};

const CLOCK_MHZ: u32 = CLOCK_HZ / 1_000_000;
const BIT_RATE_HZ: u32 = 100_000;

const ENABLE: u32 = 1 << 0;
const START: u32 = 1 << 8;
const STOP: u32 = 1 << 9;
const ACKNOWLEDGE: u32 = 1 << 10;
const ACKNOWLEDGE_NEXT: u32 = 1 << 11;
const RESET: u32 = 1 << 15;

const STARTED: u32 = 1 << 0;
const ADDRESSED: u32 = 1 << 1;
const FINISHED: u32 = 1 << 2;
const RECEIVED: u32 = 1 << 6;
const ROOM_TO_SEND: u32 = 1 << 7;
const BUS_ERROR: u32 = 1 << 8;
const ARBITRATION_LOST: u32 = 1 << 9;
const REFUSED: u32 = 1 << 10;
const FAILED: u32 = BUS_ERROR | ARBITRATION_LOST | REFUSED;
const BUSY: u32 = 1 << 1;

/// I2C1.
pub struct Bus;

/// Why a transfer failed.
#[derive(Debug)]
pub enum BusError {
    /// Nobody acknowledged.
    Refused,
    /// A start or stop where none belongs, or a second master.
    Disturbed,
    /// A line is held, or the peripheral does not answer.
    Stuck,
    /// Reading nothing, or anything behind a read.
    Unsupported,
}

impl Error for BusError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Refused => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown),
            Self::Disturbed => ErrorKind::Bus,
            Self::Stuck | Self::Unsupported => ErrorKind::Other,
        }
    }
}

impl Bus {
    /// Opens the bus.
    pub fn start() -> Self {
        configure();
        Self
    }

    /// Writes, then reads after a repeated start; either may be missing.
    fn perform(&mut self, address: SevenBitAddress, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        CR1.wait_clear(STOP).ok_or(BusError::Stuck)?;
        SR2.wait_clear(BUSY).ok_or(BusError::Stuck)?;
        // A read ends with a stop that must be announced before its last byte, so nothing can follow it.
        let reads_from = operations.iter().position(is_read).unwrap_or(operations.len());
        let (writes, reads) = operations.split_at_mut_checked(reads_from).ok_or(BusError::Unsupported)?;
        if !reads.iter().all(is_read) {
            return Err(BusError::Unsupported);
        }
        if !writes.is_empty() || reads.is_empty() {
            self.write(address, writes)?;
        }
        if reads.is_empty() {
            CR1.modify(0, STOP);
            Ok(())
        } else {
            self.read(address, reads)
        }
    }

    fn write(&mut self, address: u8, operations: &[Operation<'_>]) -> Result<(), BusError> {
        begin(address << 1)?;
        SR2.read();
        let bytes = operations.iter().flat_map(|operation| match operation {
            Operation::Write(bytes) => bytes,
            Operation::Read(_) => &[][..],
        });
        for byte in bytes {
            wait(ROOM_TO_SEND)?;
            DR.write(u32::from(*byte));
        }
        // Also true of no bytes: the address has been sent and nothing is pending.
        wait(ROOM_TO_SEND | FINISHED)
    }

    fn read(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let mut left: usize = operations.iter().map(length).sum();
        CR1.modify(ACKNOWLEDGE_NEXT, ACKNOWLEDGE);
        begin(address << 1 | 1)?;
        // The clock is held until the second status is read: time to say how the first bytes are answered.
        match left {
            0 => return Err(BusError::Unsupported),
            1 => CR1.modify(ACKNOWLEDGE, 0),
            2 => CR1.modify(ACKNOWLEDGE, ACKNOWLEDGE_NEXT),
            _ => {}
        }
        SR2.read();
        if left == 1 {
            CR1.modify(0, STOP);
        }
        let slots = operations.iter_mut().flat_map(|operation| match operation {
            Operation::Read(bytes) => bytes.iter_mut(),
            Operation::Write(_) => [].iter_mut(),
        });
        for slot in slots {
            match left {
                // This byte and the next have arrived, the clock is held: the third shall be the last.
                3 => wait(FINISHED).map(|()| CR1.modify(ACKNOWLEDGE, 0))?,
                // This byte and the last have arrived, the clock is held.
                2 => wait(FINISHED).map(|()| CR1.modify(0, STOP))?,
                _ => wait(RECEIVED)?,
            }
            let [byte, ..] = DR.read().to_le_bytes();
            *slot = byte;
            left = left.saturating_sub(1);
        }
        Ok(())
    }
}

/// Start (or repeated start), then the address with its direction; the clock is held afterwards.
fn begin(address_byte: u8) -> Result<(), BusError> {
    CR1.modify(0, START);
    wait(STARTED)?;
    DR.write(u32::from(address_byte));
    wait(ADDRESSED)
}

/// Waits for a flag or for what makes waiting vain.
fn wait(flags: u32) -> Result<(), BusError> {
    let status = SR1.wait_for(flags | FAILED).ok_or(BusError::Stuck)?;
    if status & REFUSED != 0 {
        Err(BusError::Refused)
    } else if status & FAILED != 0 {
        Err(BusError::Disturbed)
    } else {
        Ok(())
    }
}

/// Brings the peripheral into its first state, whatever state it was in.
fn configure() {
    CR1.write(RESET);
    CR1.write(0);
    CR2.write(CLOCK_MHZ);
    CCR.write(CLOCK_HZ / (2 * BIT_RATE_HZ));
    // The longest rise that the standard allows, 1 µs.
    TRISE.write(CLOCK_MHZ + 1);
    CR1.write(ENABLE);
}

fn is_read(operation: &Operation<'_>) -> bool {
    matches!(operation, Operation::Read(_))
}

fn length(operation: &Operation<'_>) -> usize {
    match operation {
        Operation::Read(bytes) => bytes.len(),
        Operation::Write(bytes) => bytes.len(),
    }
}

impl ErrorType for Bus {
    type Error = BusError;
}

impl I2c for Bus {
    fn transaction(&mut self, address: SevenBitAddress, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let result = self.perform(address, operations);
        match &result {
            Ok(()) => {}
            Err(BusError::Refused) => {
                SR1.write(0);
                CR1.modify(0, STOP);
            }
            // Nobody knows what the bus is doing; the next transfer starts from nothing.
            Err(_) => configure(),
        }
        result
    }
}
