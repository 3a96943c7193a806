//! Driver of the dual reciprocal frequency counter.
//!
//! A reciprocal counter measures how many ticks of a fast reference clock pass during a whole number
//! of cycles, so its resolution does not depend on the frequency: f = cycles · f_ref / ticks.
//! `docs/counter.md` defines the registers; values are big-endian, a read is the register's address
//! followed by the bytes.
//!
//! ```text
//! 0x00  u16  identification, 0x7C02
//! 0x02  u16  state: bit 0 gate finished, bits 1, 2 overflow of input 1, 2
//! 0x04  u32  cycles of input 1      0x08  u32  ticks during them
//! 0x0C  u32  cycles of input 2      0x10  u32  ticks during them
//! ```

use embedded_hal::spi::{Operation, SpiDevice};

const IDENTIFICATION: u8 = 0x00;
const STATE: u8 = 0x02;
const ID: u16 = 0x7C02;
const FINISHED: u16 = 1 << 0;
const OVERFLOW: u16 = 0b11 << 1;

/// A dual reciprocal counter on an SPI bus.
#[derive(Clone, Debug)]
pub struct Counter<SPI> {
    device: SPI,
    reference_hz: u32,
}

/// Frequencies of both inputs during one gate, µHz.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Resonator 1.
    pub f1_uhz: u64,
    /// Resonator 2.
    pub f2_uhz: u64,
}

/// Why there are no frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CounterError<E> {
    /// The bus failed.
    Bus(E),
    /// Another part answers.
    WrongPart(u16),
    /// The gate is still open.
    NotReady,
    /// An input stands still.
    Stopped,
    /// A count did not fit its register.
    Overflow,
    /// More cycles than ticks: no input faster than the reference clock can be counted.
    Impossible {
        /// Cycles of the input.
        cycles: u32,
        /// Ticks of the reference clock during them.
        ticks: u32,
    },
}

impl<SPI: SpiDevice> Counter<SPI> {
    /// A counter whose reference clock runs at `reference_hz`.
    pub const fn new(device: SPI, reference_hz: u32) -> Self {
        Self { device, reference_hz }
    }

    /// The device on the bus, for whoever owns the hardware.
    pub const fn device_mut(&mut self) -> &mut SPI {
        &mut self.device
    }

    /// Asks the part who it is.
    ///
    /// # Errors
    /// [`CounterError::WrongPart`] or a bus error.
    pub fn check(&mut self) -> Result<(), CounterError<SPI::Error>> {
        match u16::from_be_bytes(self.read(IDENTIFICATION)?) {
            ID => Ok(()),
            other => Err(CounterError::WrongPart(other)),
        }
    }

    /// The frequencies of the gate that finished last.
    ///
    /// # Errors
    /// Says why there are none.
    pub fn frequencies(&mut self) -> Result<Pair, CounterError<SPI::Error>> {
        // One burst: state and counts belong to the same gate.
        let bytes: [u8; 18] = self.read(STATE)?;
        let [s0, s1, words @ ..] = bytes;
        let state = u16::from_be_bytes([s0, s1]);
        if state & OVERFLOW != 0 {
            return Err(CounterError::Overflow);
        }
        if state & FINISHED == 0 {
            return Err(CounterError::NotReady);
        }
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = words;
        Ok(Pair {
            f1_uhz: self.frequency_uhz(u32::from_be_bytes([a, b, c, d]), u32::from_be_bytes([e, f, g, h]))?,
            f2_uhz: self.frequency_uhz(u32::from_be_bytes([i, j, k, l]), u32::from_be_bytes([m, n, o, p]))?,
        })
    }

    /// cycles · f_ref / ticks, rounded to the nearest µHz by integer arithmetic.
    fn frequency_uhz(&self, cycles: u32, ticks: u32) -> Result<u64, CounterError<SPI::Error>> {
        if cycles == 0 {
            return Err(CounterError::Stopped);
        }
        // From here on ticks ≥ cycles ≥ 1, so nothing overflows and nothing is divided by zero.
        if ticks < cycles {
            return Err(CounterError::Impossible { cycles, ticks });
        }
        let ticks = u64::from(ticks);
        // Whole hertz first: the product with a million would not fit 64 bits.
        let scaled = u64::from(cycles) * u64::from(self.reference_hz);
        let (whole_hz, rest) = (scaled / ticks, scaled % ticks);
        Ok(whole_hz * 1_000_000 + (rest * 1_000_000 + ticks / 2) / ticks)
    }

    fn read<const N: usize>(&mut self, register: u8) -> Result<[u8; N], CounterError<SPI::Error>> {
        let mut bytes = [0; N];
        self.device
            .transaction(&mut [Operation::Write(&[register]), Operation::Read(&mut bytes)])
            .map_err(CounterError::Bus)?;
        Ok(bytes)
    }
}
