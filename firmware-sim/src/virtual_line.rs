//! The bytes between host and virtual instrument.
//!
//! The far end runs the very `Instrument` that the microcontroller runs, fed byte by byte; only pins
//! and clock are missing.

use crate::link::Transport;
use crate::virtual_counter::VirtualCounter;
use crate::virtual_flash::{SLOT_BYTES, VirtualFlash};
use crate::virtual_thermometer::VirtualThermometer;
use firmware_core::{Counter, IdentityRecord, Instrument, Sensors, Storage, Thermometer};
use std::collections::VecDeque;
use std::convert::Infallible;

/// The instrument's program over virtual parts.
pub type Device = Instrument<VirtualCounter, VirtualThermometer, VirtualFlash>;

/// Reference clock of the counter: 100 MHz make one count of a second 0.4 mHz at 41 kHz.
const REFERENCE_HZ: u32 = 100_000_000;
const GATE_US: u32 = 1_000_000;

/// A perfect line with an instrument at its far end.
pub struct VirtualLine {
    device: Device,
    identity: IdentityRecord,
    time_us: u64,
    answers: VecDeque<u8>,
}

impl VirtualLine {
    /// A line to a new, uncalibrated instrument; a serial number is cut to what a device stores.
    #[must_use]
    pub fn new(serial: &str) -> Self {
        Self::with(IdentityRecord::new(serial), VirtualFlash::new())
    }

    /// A line to an instrument that was just powered, with this identity and these contents of its flash.
    #[must_use]
    pub fn with(identity: IdentityRecord, flash: VirtualFlash) -> Self {
        Self { device: powered(&identity, flash), identity, time_us: 0, answers: VecDeque::new() }
    }

    /// Takes the power away and gives it back. What is in flash stays; everything else begins anew, time included.
    pub fn power_cycle(&mut self) {
        let mut flash = self.flash_mut().clone();
        flash.restore_power();
        self.device = powered(&self.identity, flash);
        self.time_us = 0;
        self.answers.clear();
    }

    /// The flash with both slots.
    pub const fn flash_mut(&mut self) -> &mut VirtualFlash {
        self.device.storage_mut().flash_mut()
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

fn powered(identity: &IdentityRecord, flash: VirtualFlash) -> Device {
    let sensors = Sensors {
        counter: Counter::new(VirtualCounter::new(REFERENCE_HZ, GATE_US), REFERENCE_HZ),
        thermometer: Thermometer::new(VirtualThermometer::new(ADDRESS), ADDRESS),
    };
    Instrument::start(sensors, identity.clone(), Storage::new(flash, SLOT_BYTES))
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
        if self.answers.is_empty()
            && let Some(unasked) = self.device.poll(self.time_us)
        {
            self.answers.extend(unasked);
        }
        Ok(self.answers.pop_front())
    }
}
