//! An STM32F405 and what is connected to it. This file and `registers.rs` are the only ones that may be `unsafe`.
//!
//! Bits are those of the reference manual RM0090. The core runs on its internal 16 MHz oscillator, which needs no
//! start-up wait.
#![allow(unsafe_code)]

use crate::clock::Clock;
use crate::i2c;
use crate::pins;
use crate::registers::{nvic, rcc, scb};
use crate::serial_line::SerialLine;
use crate::spi;
use crate::timer;
use core::arch::asm;
use firmware_core::IDENTITY;

const TIM2_INTERRUPT: u32 = 1 << 28;
const USART1_INTERRUPT: u32 = 1 << (37 - 32);
const ICSR_CLEAR_SYSTICK: u32 = 1 << 25;
const AIRCR_RESET: u32 = 0x05FA_0004;

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
        rcc::AHB1ENR.modify(0, 0b11);
        rcc::APB1ENR.modify(0, 1 << 21 | 1 << 0);
        rcc::APB2ENR.modify(0, 1 << 4 | 1 << 12);
        pins::start();
        // Interrupts are never taken: pending ones end a sleep, and the loop looks what there is.
        // SAFETY: masking interrupts touches no memory.
        unsafe { asm!("cpsid i", options(nomem, nostack, preserves_flags)) };
        nvic::ISER0.write(TIM2_INTERRUPT);
        nvic::ISER1.write(USART1_INTERRUPT);
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
        timer::start(longest_us);
    }
    // SAFETY: waiting for an interrupt touches no memory.
    unsafe { asm!("wfi", options(nomem, nostack, preserves_flags)) };
    timer::stop();
    nvic::ICPR0.write(TIM2_INTERRUPT);
    nvic::ICPR1.write(USART1_INTERRUPT);
    scb::ICSR.write(ICSR_CLEAR_SYSTICK);
}

/// Starts the processor anew.
pub fn reset() -> ! {
    scb::AIRCR.write(AIRCR_RESET);
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
