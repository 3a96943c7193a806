//! The bytes between host and virtual instrument.
//!
//! The far end runs the very `Instrument` that the microcontroller runs, fed byte by byte; only pins
//! and clock are missing.

use crate::link::Transport;
use crate::virtual_counter::VirtualCounter;
use crate::virtual_thermometer::VirtualThermometer;
use firmware_core::{Counter, Instrument, Sensors, Thermometer};
use protocol::limits::MAX_NAME;
use std::collections::VecDeque;
use std::convert::Infallible;

/// The instrument's program over virtual parts.
pub type Device = Instrument<VirtualCounter, VirtualThermometer>;

/// Reference clock of the counter: 100 MHz make one count of a second 0.4 mHz at 41 kHz.
const REFERENCE_HZ: u32 = 100_000_000;
const GATE_US: u32 = 1_000_000;

/// A perfect line with an instrument at its far end.
pub struct VirtualLine {
    device: Device,
    time_us: u64,
    answers: VecDeque<u8>,
}

impl VirtualLine {
    /// A line to a new, uncalibrated instrument; a serial number is cut to what a device stores.
    #[must_use]
    pub fn new(serial: &str) -> Self {
        let sensors = Sensors {
            counter: Counter::new(VirtualCounter::new(REFERENCE_HZ, GATE_US), REFERENCE_HZ),
            thermometer: Thermometer::new(VirtualThermometer::new(ADDRESS), ADDRESS),
        };
        let end = serial.floor_char_boundary(MAX_NAME);
        let serial = serial[..end].try_into().unwrap_or_default();
        Self { device: Instrument::new(sensors, serial), time_us: 0, answers: VecDeque::new() }
    }

    /// The instrument's clock.
    pub const fn set_time_us(&mut self, time_us: u64) {
        self.time_us = time_us;
    }

    /// The instrument itself, past the line.
    pub const fn device_mut(&mut self) -> &mut Device {
        &mut self.device
    }

    /// The counter on its SPI bus.
    pub const fn counter_mut(&mut self) -> &mut VirtualCounter {
        self.device.sensors_mut().counter.device_mut()
    }

    /// The thermometer on its I²C bus.
    pub const fn thermometer_mut(&mut self) -> &mut VirtualThermometer {
        self.device.sensors_mut().thermometer.bus_mut()
    }
}

const ADDRESS: u8 = Thermometer::<VirtualThermometer>::ADDRESS;

impl Transport for VirtualLine {
    type Error = Infallible;

    fn send(&mut self, bytes: &[u8]) -> Result<(), Infallible> {
        for byte in bytes {
            if let Some(answer) = self.device.receive(*byte, self.time_us) {
                self.answers.extend(answer);
            }
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<u8>, Infallible> {
        Ok(self.answers.pop_front())
    }
}
