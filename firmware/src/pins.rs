//! Which pin belongs to whom.
//!
//! ```text
//! PA9, PA10        USART1   line to the host
//! PA4              output   chip select of the counter
//! PA5, PA6, PA7    SPI1     counter
//! PB6, PB7         I2C1     thermometer, with pull-ups on the board
//! ```

use crate::registers::{PORT_A, PORT_B, Port, Register};

/// The pin of port A that selects the counter.
const CHIP_SELECT: u32 = 4;

/// Connects every pin to what the board has it for.
pub fn start() {
    for pin in [9, 10] {
        connect(&PORT_A, pin, 7);
    }
    for pin in [5, 6, 7] {
        connect(&PORT_A, pin, 5);
    }
    for pin in [6, 7] {
        PORT_B.otyper().modify(0, 1 << pin);
        connect(&PORT_B, pin, 4);
    }
    select_counter(false);
    PORT_A.moder().modify(0b11 << (2 * CHIP_SELECT), 0b01 << (2 * CHIP_SELECT));
}

/// Selects the counter on its bus, or lets it go.
pub fn select_counter(selected: bool) {
    PORT_A.bsrr().write(if selected { 1 << (CHIP_SELECT + 16) } else { 1 << CHIP_SELECT });
}

/// Connects a pin to a peripheral, by the peripheral's number in the data sheet's table.
fn connect(port: &Port, pin: u32, function: u32) {
    let half: Register = if pin < 8 { port.afrl() } else { port.afrh() };
    half.modify(0xF << (4 * (pin % 8)), function << (4 * (pin % 8)));
    port.moder().modify(0b11 << (2 * pin), 0b10 << (2 * pin));
}
