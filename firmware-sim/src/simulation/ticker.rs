//! How far a simulation is, and whether it is to stop.

use super::error::SimulateError;
use std::ops::ControlFlow;

/// Tells how far the simulation is, at every whole percent.
pub(super) struct Ticker<'a> {
    pub(super) progress: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
    pub(super) done_s: f64,
    pub(super) total_s: f64,
    pub(super) told: f64,
}

impl Ticker<'_> {
    pub(super) fn pass(&mut self, dt_s: f64) -> Result<(), SimulateError> {
        self.done_s += dt_s;
        let fraction = self.done_s / self.total_s;
        if fraction < self.told + 0.01 {
            return Ok(());
        }
        self.told = fraction;
        match (self.progress)(fraction.min(1.0)) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(SimulateError::Stopped { percent: fraction * 100.0 }),
        }
    }
}
