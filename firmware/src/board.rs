//! An STM32F405 with its registers: the only file that may be `unsafe`.
//!
//! ```text
//! PA9, PA10        USART1   line to the host
//! PA4              output   chip select of the counter
//! PA5, PA6, PA7    SPI1     counter
//! PB6, PB7         I2C1     thermometer, with pull-ups on the board
//! ```
//! Addresses and bits are those of the reference manual RM0090. The core runs on its internal 16 MHz
//! oscillator, which needs no start-up wait. Every wait for a peripheral ends after [`PATIENCE`] looks.
#![allow(unsafe_code)]

use crate::clock::Clock;
use crate::i2c;
use crate::serial_line::SerialLine;
use crate::spi;
use core::arch::asm;
use firmware_core::IDENTITY;

/// The core's and all buses' clock.
pub const CLOCK_HZ: u32 = 16_000_000;

/// Looks at a flag before giving up: at least 10 ms, where a byte takes 0.1 ms.
const PATIENCE: u32 = 40_000;

/// One 32-bit register. Its address is fixed here, so reading and writing it is sound.
#[derive(Clone, Copy)]
pub struct Register(u32);

impl Register {
    /// Its value.
    pub fn read(self) -> u32 {
        // SAFETY: only this file makes registers, each the aligned address of one that exists.
        unsafe { (self.0 as *const u32).read_volatile() }
    }

    /// Gives it a value.
    pub fn write(self, value: u32) {
        // SAFETY: as above; none of these registers can make the processor touch memory.
        unsafe { (self.0 as *mut u32).write_volatile(value) }
    }

    /// Sets and clears bits.
    pub fn modify(self, clear: u32, set: u32) {
        self.write(self.read() & !clear | set);
    }

    /// Waits until one of `bits` is set; `None` if that takes too long.
    pub fn wait_for(self, bits: u32) -> Option<u32> {
        (0..PATIENCE).map(|_| self.read()).find(|value| value & bits != 0)
    }

    /// Waits until all of `bits` are clear; `None` if that takes too long.
    pub fn wait_clear(self, bits: u32) -> Option<u32> {
        (0..PATIENCE).map(|_| self.read()).find(|value| value & bits == 0)
    }
}

const RCC: u32 = 0x4002_3800;
const RCC_AHB1ENR: Register = Register(RCC + 0x30);
const RCC_APB1ENR: Register = Register(RCC + 0x40);
const RCC_APB2ENR: Register = Register(RCC + 0x44);

const NVIC_ISER0: Register = Register(0xE000_E100);
const NVIC_ICPR0: Register = Register(0xE000_E280);
const TIM2_INTERRUPT: u32 = 1 << 28;
const NVIC_ISER1: Register = Register(0xE000_E104);
const NVIC_ICPR1: Register = Register(0xE000_E284);
const USART1_INTERRUPT: u32 = 1 << (37 - 32);

const SCB_ICSR: Register = Register(0xE000_ED04);
const SCB_AIRCR: Register = Register(0xE000_ED0C);
const ICSR_CLEAR_SYSTICK: u32 = 1 << 25;
const AIRCR_RESET: u32 = 0x05FA_0004;

/// The system timer.
pub mod systick {
    use super::Register;

    /// Control and status.
    pub const CSR: Register = Register(0xE000_E010);
    /// Reload value.
    pub const RVR: Register = Register(0xE000_E014);
    /// Current value.
    pub const CVR: Register = Register(0xE000_E018);
}

/// The timer that ends a sleep. It runs once: QEMU's fires without end otherwise.
mod tim2 {
    use super::{CLOCK_HZ, Register};

    const BASE: u32 = 0x4000_0000;
    const CR1: Register = Register(BASE);
    const DIER: Register = Register(BASE + 0x0C);
    const SR: Register = Register(BASE + 0x10);
    const EGR: Register = Register(BASE + 0x14);
    const PSC: Register = Register(BASE + 0x28);
    const ARR: Register = Register(BASE + 0x2C);

    const RUN: u32 = 1 << 0;
    /// Only the end of the time is an event, not the update that begins it.
    const END_ONLY: u32 = 1 << 2;
    const ONCE: u32 = 1 << 3;

    /// Lets the interrupt become pending after this time.
    pub fn start(after_us: u32) {
        PSC.write(CLOCK_HZ / 1_000_000 - 1);
        ARR.write(after_us);
        DIER.write(1);
        CR1.write(END_ONLY);
        EGR.write(1);
        CR1.write(END_ONLY | ONCE | RUN);
    }

    /// Whatever it was doing, it is over.
    pub fn stop() {
        CR1.write(0);
        SR.write(0);
    }
}

/// What erases and writes the flash.
pub mod flash {
    use super::Register;

    const BASE: u32 = 0x4002_3C00;
    /// Access, caches.
    pub const ACR: Register = Register(BASE);
    /// Keys.
    pub const KEYR: Register = Register(BASE + 0x04);
    /// Status.
    pub const SR: Register = Register(BASE + 0x0C);
    /// Control.
    pub const CR: Register = Register(BASE + 0x10);
}

/// The line to the host.
pub mod usart1 {
    use super::Register;

    const BASE: u32 = 0x4001_1000;
    /// Status.
    pub const SR: Register = Register(BASE);
    /// Data.
    pub const DR: Register = Register(BASE + 0x04);
    /// Baud rate.
    pub const BRR: Register = Register(BASE + 0x08);
    /// Control.
    pub const CR1: Register = Register(BASE + 0x0C);
}

/// The bus to the counter.
pub mod spi1 {
    use super::Register;

    const BASE: u32 = 0x4001_3000;
    /// Control.
    pub const CR1: Register = Register(BASE);
    /// Status.
    pub const SR: Register = Register(BASE + 0x08);
    /// Data.
    pub const DR: Register = Register(BASE + 0x0C);
}

/// The bus to the thermometer.
pub mod i2c1 {
    use super::Register;

    const BASE: u32 = 0x4000_5400;
    /// Control.
    pub const CR1: Register = Register(BASE);
    /// Clock of the bus's own logic.
    pub const CR2: Register = Register(BASE + 0x04);
    /// Data.
    pub const DR: Register = Register(BASE + 0x10);
    /// Status.
    pub const SR1: Register = Register(BASE + 0x14);
    /// More status; reading it after the first clears the address flag.
    pub const SR2: Register = Register(BASE + 0x18);
    /// Bit rate.
    pub const CCR: Register = Register(BASE + 0x1C);
    /// Rise time.
    pub const TRISE: Register = Register(BASE + 0x20);
}

/// A port of sixteen pins.
struct Port(u32);

const PORT_A: Port = Port(0x4002_0000);
const PORT_B: Port = Port(0x4002_0400);
const CHIP_SELECT: u32 = 4;

impl Port {
    /// Connects a pin to a peripheral, by the peripheral's number in the data sheet's table.
    fn connect(&self, pin: u32, function: u32) {
        let half = Register(self.0 + 0x20 + 4 * (pin / 8));
        half.modify(0xF << (4 * (pin % 8)), function << (4 * (pin % 8)));
        Register(self.0).modify(0b11 << (2 * pin), 0b10 << (2 * pin));
    }

    fn make_output(&self, pin: u32) {
        Register(self.0).modify(0b11 << (2 * pin), 0b01 << (2 * pin));
    }

    fn make_open_drain(&self, pin: u32) {
        Register(self.0 + 0x04).modify(0, 1 << pin);
    }

    fn set(&self, pin: u32, high: bool) {
        Register(self.0 + 0x18).write(if high { 1 << pin } else { 1 << (pin + 16) });
    }
}

/// Selects the counter on its bus, or lets it go.
pub fn select_counter(selected: bool) {
    PORT_A.set(CHIP_SELECT, !selected);
}

/// What the board offers, ready to use.
pub struct Board {
    /// The bus with the counter.
    pub counter: spi::Device,
    /// The bus with the thermometer.
    pub thermometer: i2c::Bus,
    /// Time.
    pub clock: Clock,
    /// The line to the host.
    pub line: SerialLine,
}

impl Board {
    /// Starts everything.
    pub fn start() -> Self {
        RCC_AHB1ENR.modify(0, 0b11);
        RCC_APB1ENR.modify(0, 1 << 21 | 1 << 0);
        RCC_APB2ENR.modify(0, 1 << 4 | 1 << 12);
        for pin in [9, 10] {
            PORT_A.connect(pin, 7);
        }
        for pin in [5, 6, 7] {
            PORT_A.connect(pin, 5);
        }
        for pin in [6, 7] {
            PORT_B.make_open_drain(pin);
            PORT_B.connect(pin, 4);
        }
        select_counter(false);
        PORT_A.make_output(CHIP_SELECT);
        // Interrupts are never taken: pending ones end a sleep, and the loop looks what there is.
        // SAFETY: masking interrupts touches no memory.
        unsafe { asm!("cpsid i", options(nomem, nostack, preserves_flags)) };
        NVIC_ISER0.write(TIM2_INTERRUPT);
        NVIC_ISER1.write(USART1_INTERRUPT);
        Self {
            counter: spi::Device::start(),
            thermometer: i2c::Bus::start(),
            clock: Clock::start(),
            line: SerialLine::start(),
        }
    }
}

/// Sleeps until a byte arrived, the clock turned or `longest_us` went by; returns at once if one of them already happened.
pub fn sleep(longest_us: Option<u32>) {
    if let Some(longest_us) = longest_us {
        tim2::start(longest_us);
    }
    // SAFETY: waiting for an interrupt touches no memory.
    unsafe { asm!("wfi", options(nomem, nostack, preserves_flags)) };
    tim2::stop();
    NVIC_ICPR0.write(TIM2_INTERRUPT);
    NVIC_ICPR1.write(USART1_INTERRUPT);
    SCB_ICSR.write(ICSR_CLEAR_SYSTICK);
}

/// Starts the processor anew.
pub fn reset() -> ! {
    SCB_AIRCR.write(AIRCR_RESET);
    loop {
        core::hint::spin_loop();
    }
}

// memory.x places both. Any bytes are valid; nothing writes the first while the program runs.
unsafe extern "C" {
    #[link_name = "_identity"]
    safe static IDENTITY_RECORD: [u8; IDENTITY];
    #[link_name = "_calibration"]
    safe static SLOTS: [u8; 2 * SLOT_BYTES as usize];
}

/// Bytes of one slot: a sector.
pub const SLOT_BYTES: u32 = 128 * 1024;

/// The record of who the sensor is.
pub fn identity() -> &'static [u8; IDENTITY] {
    &IDENTITY_RECORD
}

/// A byte of the slots, as it is now.
pub fn read_slots(at: u32) -> Option<u8> {
    // SAFETY: an address within both slots; volatile, because the flash changes them behind the compiler's back.
    (at < 2 * SLOT_BYTES).then(|| unsafe { (&raw const SLOTS).cast::<u8>().add(at as usize).read_volatile() })
}

/// Hands a word of the slots to the flash, which is open for writing.
pub fn write_slots(at: u32, word: u32) -> Option<()> {
    // SAFETY: an aligned address within both slots, which are no memory of Rust's: they are read as volatile.
    (at % 4 == 0 && at < 2 * SLOT_BYTES)
        .then(|| unsafe { (&raw const SLOTS).cast_mut().cast::<u32>().add(at as usize / 4).write_volatile(word) })
}
