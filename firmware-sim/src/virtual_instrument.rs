//! An instrument that exists only in memory: real program, real frames, virtual parts.
//!
//! What a host does with the instrument on its bench it can do with this one, and get the same bits.

use crate::link::{Kept, Link, LinkError};
use crate::virtual_counter::VirtualCounter;
use crate::virtual_line::VirtualLine;
use crate::virtual_thermometer::VirtualThermometer;
use protocol::{Blob, Reading, Request, Response, Sample};

/// A virtual instrument and the line to it.
pub struct VirtualInstrument {
    link: Link<VirtualLine>,
}

impl VirtualInstrument {
    /// A new, uncalibrated instrument.
    #[must_use]
    pub fn new(serial: &str) -> Self {
        Self { link: Link::new(VirtualLine::new(serial)) }
    }

    /// Sends a request through frames and bytes and returns the answer. A refusal is an answer.
    ///
    /// # Errors
    /// A [`LinkError`]; over this line only a request or an answer that fits no frame.
    pub fn exchange(&mut self, request: Request) -> Result<Response, LinkError> {
        self.link.exchange(request)
    }

    /// Writes a calibration in pieces and has it used.
    ///
    /// # Errors
    /// [`LinkError::Refused`] with the instrument's reason; the old calibration then runs on.
    pub fn upload(&mut self, blob: &Blob) -> Result<Kept, LinkError> {
        self.link.upload_blob(blob)
    }

    /// The reading of each sample, in order.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn replay(&mut self, samples: &[Sample]) -> Result<Vec<Reading>, LinkError> {
        samples.iter().map(|sample| self.link.replay(sample)).collect()
    }

    /// Measures once through the drivers, with the parts as [`Self::set`] left them.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn measure(&mut self) -> Result<(Sample, Reading), LinkError> {
        self.link.measure()
    }

    /// Lets the resonators vibrate at these frequencies during one gate of the counter, and the
    /// thermometer convert once at this temperature. Negative and non-finite values count as zero.
    pub fn set(&mut self, f1_hz: f64, f2_hz: f64, temperature_c: f64) {
        // The casts saturate, and turn NaN into zero.
        self.counter_mut().finish_gate((f1_hz * 1e6).round() as u64, (f2_hz * 1e6).round() as u64);
        self.thermometer_mut().convert((temperature_c * 1e6).round() as i32);
    }

    /// Takes the power away and gives it back; what is in flash stays.
    pub fn power_cycle(&mut self) {
        self.link.transport_mut().power_cycle();
        // A new power-on is a new conversation.
        self.link.begin();
    }

    /// Sets the instrument's clock.
    pub const fn set_time_us(&mut self, time_us: u64) {
        self.link.transport_mut().set_time_us(time_us);
    }

    /// The counter, to let it fail.
    pub const fn counter_mut(&mut self) -> &mut VirtualCounter {
        self.link.transport_mut().counter_mut()
    }

    /// The thermometer, to let it fail.
    pub const fn thermometer_mut(&mut self) -> &mut VirtualThermometer {
        self.link.transport_mut().thermometer_mut()
    }

    /// The conversation, for everything that has no short form here.
    pub const fn link_mut(&mut self) -> &mut Link<VirtualLine> {
        &mut self.link
    }
}
