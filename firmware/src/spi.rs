//! The bus to the counter: SPI mode 0, 1 Mbit/s, the counter alone on it.

use crate::pins::select_counter;
use crate::registers::spi1::{CR1, DR, SR};
use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiDevice};

const ENABLE: u32 = 1 << 6;
const MASTER: u32 = 1 << 2;
/// 16 MHz / 16.
const BIT_RATE: u32 = 0b011 << 3;
/// Chip select is an ordinary pin, so the peripheral must not look for one.
const SOFTWARE_SELECT: u32 = 1 << 9 | 1 << 8;
const RECEIVED: u32 = 1 << 0;
const ROOM_TO_SEND: u32 = 1 << 1;
const BUSY: u32 = 1 << 7;

/// The counter on SPI1.
pub struct Device;

/// The peripheral did not move a byte in time.
#[derive(Debug)]
pub struct Silent;

impl Error for Silent {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl Device {
    /// Opens the bus.
    pub fn start() -> Self {
        CR1.write(SOFTWARE_SELECT | BIT_RATE | MASTER | ENABLE);
        Self
    }

    /// Shifts one byte out and one in.
    fn shift(&mut self, byte: u8) -> Result<u8, Silent> {
        SR.wait_for(ROOM_TO_SEND).ok_or(Silent)?;
        DR.write(u32::from(byte));
        SR.wait_for(RECEIVED).ok_or(Silent)?;
        let [received, ..] = DR.read().to_le_bytes();
        Ok(received)
    }

    fn perform(&mut self, operation: &mut Operation<'_, u8>) -> Result<(), Silent> {
        match operation {
            Operation::Read(bytes) => bytes.iter_mut().try_for_each(|slot| self.shift(0).map(|byte| *slot = byte)),
            Operation::Write(bytes) => bytes.iter().try_for_each(|byte| self.shift(*byte).map(drop)),
            Operation::Transfer(read, write) => self.transfer(read, write),
            Operation::TransferInPlace(bytes) => {
                bytes.iter_mut().try_for_each(|slot| self.shift(*slot).map(|byte| *slot = byte))
            }
            Operation::DelayNs(duration_ns) => {
                // A turn of the loop takes more than one of the 62 ns of a clock.
                (0..*duration_ns / 62).for_each(|_| core::hint::spin_loop());
                Ok(())
            }
        }
    }

    /// Both at once, the shorter one filled up with zeros.
    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Silent> {
        let (mut slots, mut bytes) = (read.iter_mut(), write.iter());
        for _ in 0..slots.len().max(bytes.len()) {
            let received = self.shift(bytes.next().copied().unwrap_or(0))?;
            if let Some(slot) = slots.next() {
                *slot = received;
            }
        }
        Ok(())
    }
}

impl ErrorType for Device {
    type Error = Silent;
}

impl SpiDevice for Device {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Silent> {
        select_counter(true);
        let result = operations.iter_mut().try_for_each(|operation| self.perform(operation));
        let idle = SR.wait_clear(BUSY).ok_or(Silent).map(drop);
        select_counter(false);
        result.and(idle)
    }
}
