//! The dual reciprocal counter on a virtual SPI bus, at the level of its registers.
//!
//! Apart from the twin's counter: that one says which frequency a counter would show, this one how
//! the part says it. `docs/counter.md` defines the registers. All arithmetic is in integers, so
//! what a gate holds can be checked exactly.

use crate::virtual_fault::{BusError, PartFault};
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

const ID: u16 = 0x7C02;
const STATE: usize = 0x02;
const INPUTS: [usize; 2] = [0x04, 0x0C];
const REGISTERS: usize = 0x14;
const FINISHED: u16 = 1 << 0;
const OVERFLOW: [u16; 2] = [1 << 1, 1 << 2];

/// A dual reciprocal counter, alone on its bus.
#[derive(Clone, Debug)]
pub struct VirtualCounter {
    /// How it misbehaves.
    pub fault: PartFault,
    reference_hz: u32,
    gate_us: u32,
    registers: [u8; REGISTERS],
}

/// Whole cycles of one input and the ticks during them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// Cycles of the input.
    pub cycles: u128,
    /// Ticks of the reference clock during them.
    pub ticks: u128,
}

impl Count {
    /// What a gate of `gate_us` counts of an input: the cycles that fit into it, at least one, and
    /// the ticks that end within them. Zero cycles of an input that stands still.
    #[must_use]
    pub fn of(frequency_uhz: u64, reference_hz: u32, gate_us: u32) -> Self {
        let frequency_uhz = u128::from(frequency_uhz);
        if frequency_uhz == 0 {
            return Self { cycles: 0, ticks: u128::from(reference_hz) * u128::from(gate_us) / 1_000_000 };
        }
        let cycles = (frequency_uhz * u128::from(gate_us) / 1_000_000_000_000).max(1);
        Self { cycles, ticks: cycles * u128::from(reference_hz) * 1_000_000 / frequency_uhz }
    }
}

impl VirtualCounter {
    /// A part that was just powered; its first gate is still open.
    #[must_use]
    pub fn new(reference_hz: u32, gate_us: u32) -> Self {
        let mut registers = [0; REGISTERS];
        registers[..2].copy_from_slice(&ID.to_be_bytes());
        Self { fault: PartFault::None, reference_hz, gate_us, registers }
    }

    /// Closes a gate over both inputs' frequencies; 0 is an input that stands still.
    pub fn finish_gate(&mut self, f1_uhz: u64, f2_uhz: u64) {
        if self.fault == PartFault::Stuck {
            return;
        }
        let mut state = FINISHED;
        for ((frequency_uhz, at), overflow) in [f1_uhz, f2_uhz].into_iter().zip(INPUTS).zip(OVERFLOW) {
            let count = Count::of(frequency_uhz, self.reference_hz, self.gate_us);
            for (value, at) in [(count.cycles, at), (count.ticks, at + 4)] {
                let stored = u32::try_from(value).unwrap_or_else(|_| {
                    state |= overflow;
                    u32::MAX
                });
                self.store(at, &stored.to_be_bytes());
            }
        }
        self.store(STATE, &state.to_be_bytes());
    }

    /// Puts any bytes into the registers from `address` on, as no gate would.
    pub fn store(&mut self, address: usize, bytes: &[u8]) {
        for (slot, byte) in self.registers.iter_mut().skip(address).zip(bytes) {
            *slot = *byte;
        }
    }

    /// The byte at an address; beyond the last register the part shifts out zeros.
    fn byte(&self, address: usize) -> u8 {
        match self.fault {
            PartFault::Absent => 0xFF,
            PartFault::OtherPart(id) if address < 2 => id.to_be_bytes()[address],
            _ => self.registers.get(address).copied().unwrap_or(0),
        }
    }

    /// Shifts one operation through; `address` is the register address once the first byte came.
    fn perform(&mut self, operation: &mut Operation<'_, u8>, address: &mut Option<usize>) -> Result<(), BusError> {
        match operation {
            Operation::Write(bytes) => bytes.iter().try_for_each(|byte| self.shift(*byte, address).map(drop)),
            Operation::Read(bytes) => {
                bytes.iter_mut().try_for_each(|slot| self.shift(0, address).map(|byte| *slot = byte))
            }
            Operation::Transfer(read, write) => (0..read.len().max(write.len())).try_for_each(|i| {
                let byte = self.shift(write.get(i).copied().unwrap_or(0), address)?;
                if let Some(slot) = read.get_mut(i) {
                    *slot = byte;
                }
                Ok(())
            }),
            Operation::TransferInPlace(bytes) => {
                bytes.iter_mut().try_for_each(|slot| self.shift(*slot, address).map(|byte| *slot = byte))
            }
            Operation::DelayNs(_) => Ok(()),
        }
    }

    fn shift(&mut self, sent: u8, address: &mut Option<usize>) -> Result<u8, BusError> {
        self.fault.pass_byte()?;
        let Some(at) = address else {
            *address = Some(usize::from(sent));
            return Ok(0);
        };
        let byte = self.byte(*at);
        // Reading the state's low byte takes the gate: the same one is not handed out twice.
        if *at == STATE + 1 && self.fault != PartFault::Absent {
            self.registers[STATE + 1] &= !FINISHED.to_be_bytes()[1];
        }
        *at += 1;
        Ok(byte)
    }
}

impl ErrorType for VirtualCounter {
    type Error = BusError;
}

impl SpiDevice for VirtualCounter {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), BusError> {
        let mut address = None;
        operations.iter_mut().try_for_each(|operation| self.perform(operation, &mut address))
    }
}
