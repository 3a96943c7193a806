//! A bench that never ends: the virtual instrument lives through a scenario of the twin, over and over.

use crate::recording::{Recording, Row};
use crate::virtual_counter::VirtualCounter;
use crate::virtual_thermometer::VirtualThermometer;

/// What the sensors of an instrument on the bench see, second by second.
pub struct VirtualBench {
    rows: Vec<Row>,
    passed: Option<u64>,
}

/// The counter closes a gate and the thermometer converts this often, µs.
const EVERY_US: u64 = 1_000_000;

impl VirtualBench {
    /// The runs of a recording, one behind the other, one row a second.
    #[must_use]
    pub fn new(recording: Recording) -> Self {
        Self { rows: recording.runs.into_iter().flat_map(|run| run.rows).collect(), passed: None }
    }

    /// Lets the sensors see what there is at this time of the instrument; the seconds in between went by.
    pub fn advance(&mut self, time_us: u64, counter: &mut VirtualCounter, thermometer: &mut VirtualThermometer) {
        let second = time_us / EVERY_US;
        if self.passed == Some(second) || self.rows.is_empty() {
            return;
        }
        self.passed = Some(second);
        let row = &self.rows[(second % self.rows.len() as u64) as usize];
        // The casts saturate, and turn NaN into zero.
        counter.finish_gate((row.f1_hz * 1e6).round() as u64, (row.f2_hz * 1e6).round() as u64);
        thermometer.convert((row.temperature_c * 1e6).round() as i32);
    }
}
