//! The image for the microcontroller: pins, clocks, loop. Everything that computes is in `firmware-core`.
#![no_std]
#![no_main]

mod board;
mod clock;
mod flash;
mod i2c;
mod pins;
mod registers;
mod serial_line;
mod spi;
mod timer;

use board::Board;
#[cfg(feature = "log")]
use cortex_m as _;
#[cfg(feature = "log-rtt")]
use defmt_rtt as _;
#[cfg(feature = "log-semihosting")]
use defmt_semihosting as _;
use firmware_core::{Counter, IdentityRecord, Instrument, Sensors, Storage, Thermometer, log};

/// The counter's reference clock.
const REFERENCE_HZ: u32 = 100_000_000;

#[cortex_m_rt::entry]
fn main() -> ! {
    log::power_on();
    let Board { counter, thermometer, mut clock, mut line } = Board::start();
    let sensors = Sensors {
        counter: Counter::new(counter, REFERENCE_HZ),
        thermometer: Thermometer::new(thermometer, Thermometer::<i2c::Bus>::ADDRESS),
    };
    let identity = IdentityRecord::from_bytes(board::identity());
    let mut instrument = Instrument::start(sensors, identity, Storage::new(flash::Flash, board::SLOT_BYTES));
    loop {
        let time_us = clock.now_us();
        if let Some(message) = instrument.poll(time_us) {
            line.send(message);
        }
        match line.receive() {
            Some(byte) => {
                if let Some(answer) = instrument.receive(byte, time_us) {
                    line.send(answer);
                }
            }
            None => board::sleep(instrument.wake_every_us()),
        }
    }
}

/// No path of the image leads here, which `.ci/firmware` checks. If one ever does: begin anew, measuring matters more.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    board::reset()
}
