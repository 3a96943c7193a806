//! The line to the host: 115 200 baud, 8 bits, no parity.

use crate::clock::CLOCK_HZ;
use crate::registers::usart1::{BRR, CR1, DR, SR};

const BAUD: u32 = 115_200;
const ENABLE: u32 = 1 << 13;
const INTERRUPT_ON_BYTE: u32 = 1 << 5;
const TRANSMITTER: u32 = 1 << 3;
const RECEIVER: u32 = 1 << 2;
const BYTE_RECEIVED: u32 = 1 << 5;
const OVERRUN: u32 = 1 << 3;
const ROOM_TO_SEND: u32 = 1 << 7;

/// USART1.
pub struct SerialLine;

impl SerialLine {
    /// Opens the line.
    pub fn start() -> Self {
        BRR.write((CLOCK_HZ + BAUD / 2) / BAUD);
        CR1.write(ENABLE | INTERRUPT_ON_BYTE | TRANSMITTER | RECEIVER);
        Self
    }

    /// The byte that arrived, if one did.
    pub fn receive(&mut self) -> Option<u8> {
        let status = SR.read();
        if status & (BYTE_RECEIVED | OVERRUN) == 0 {
            return None;
        }
        // Reading the data also clears an overrun; the frame that lost a byte fails its checksum.
        let [byte, ..] = DR.read().to_le_bytes();
        (status & BYTE_RECEIVED != 0).then_some(byte)
    }

    /// Sends bytes. If the line gives no room the rest is dropped: the host asks again.
    pub fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if SR.wait_for(ROOM_TO_SEND).is_none() {
                return;
            }
            DR.write(u32::from(*byte));
        }
    }
}
