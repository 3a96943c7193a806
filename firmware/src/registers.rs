//! The registers of an STM32F405 that the image uses, each at its address.
//!
//! Addresses are those of the reference manual RM0090. What the bits mean stands in the file that uses them. Every wait for
//! a peripheral ends after [`PATIENCE`] looks.
#![allow(unsafe_code)]

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

/// Which peripherals have a clock.
pub mod rcc {
    use super::Register;

    const BASE: u32 = 0x4002_3800;
    /// Ports.
    pub const AHB1ENR: Register = Register(BASE + 0x30);
    /// The slower bus.
    pub const APB1ENR: Register = Register(BASE + 0x40);
    /// The faster bus.
    pub const APB2ENR: Register = Register(BASE + 0x44);
}

/// Interrupts 0 to 31 and 32 to 63.
pub mod nvic {
    use super::Register;

    /// Enables.
    pub const ISER0: Register = Register(0xE000_E100);
    /// Enables.
    pub const ISER1: Register = Register(0xE000_E104);
    /// Makes no longer pending.
    pub const ICPR0: Register = Register(0xE000_E280);
    /// Makes no longer pending.
    pub const ICPR1: Register = Register(0xE000_E284);
}

/// The processor itself.
pub mod scb {
    use super::Register;

    /// What is pending.
    pub const ICSR: Register = Register(0xE000_ED04);
    /// Starting anew.
    pub const AIRCR: Register = Register(0xE000_ED0C);
}

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

/// The timer that ends a sleep.
pub mod tim2 {
    use super::Register;

    const BASE: u32 = 0x4000_0000;
    /// Control.
    pub const CR1: Register = Register(BASE);
    /// Interrupts.
    pub const DIER: Register = Register(BASE + 0x0C);
    /// Status.
    pub const SR: Register = Register(BASE + 0x10);
    /// Events by hand.
    pub const EGR: Register = Register(BASE + 0x14);
    /// Ticks of the clock to one of the timer.
    pub const PSC: Register = Register(BASE + 0x28);
    /// Where it ends.
    pub const ARR: Register = Register(BASE + 0x2C);
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
pub struct Port(u32);

/// Port A.
pub const PORT_A: Port = Port(0x4002_0000);
/// Port B.
pub const PORT_B: Port = Port(0x4002_0400);

impl Port {
    /// What each pin is: input, output or a peripheral's. Two bits a pin.
    pub fn moder(&self) -> Register {
        Register(self.0)
    }

    /// Which pins only pull down.
    pub fn otyper(&self) -> Register {
        Register(self.0 + 0x04)
    }

    /// Sets pins by its lower half and clears them by its upper one.
    pub fn bsrr(&self) -> Register {
        Register(self.0 + 0x18)
    }

    /// Whose pins 0 to 7 are. Four bits a pin.
    pub fn afrl(&self) -> Register {
        Register(self.0 + 0x20)
    }

    /// Whose pins 8 to 15 are. Four bits a pin.
    pub fn afrh(&self) -> Register {
        Register(self.0 + 0x24)
    }
}
