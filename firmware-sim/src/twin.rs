//! The digital twin: what a resonant accelerometer in a laboratory would have measured.
//!
//! Apart from everything that is tested against it: it shares no formula with the instrument's firmware. Its physics is
//! that of the cited papers and standards, in f64, one step a second, from a seed.

use std::ops::ControlFlow;

use crate::recording::Recording;
use crate::scenario::timeline::Timeline;
use crate::scenario::{Scenario, ScenarioError};
use crate::twin::play::Twin;

pub mod conditions;
pub mod counter;
pub mod effect;
mod lag;
pub mod noise;
pub mod noise_floor;
mod play;
pub mod random;
mod rig_error;
pub mod static_map;
mod thermal;
mod thermometer;
pub mod truth;

pub use noise::Noise;
pub use noise_floor::{NoiseFloor, noise_floor_ug};
pub use static_map::StaticMap;
pub use truth::Truth;

/// Why there is no recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The scenario cannot be carried out.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// `progress` asked to stop.
    #[error("the simulation was stopped after {percent:.0} %")]
    Stopped {
        /// How much was done, percent.
        percent: f64,
    },
}

/// Measures a campaign. The same scenario and seed give the same recording, bit by bit.
///
/// `progress` is told the fraction done, about a hundred times, and may stop the simulation.
///
/// # Errors
/// If the scenario cannot be carried out, or `progress` stopped it.
pub fn simulate(
    scenario: &Scenario,
    seed: u64,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Recording, SimulateError> {
    scenario.check()?;
    let timeline = Timeline::of(scenario, seed)?;
    let mut ticker = Ticker { progress, done_s: 0.0, total_s: timeline.duration_s(), told: 0.0 };
    let mut twin = Twin::new(scenario, seed);
    let mut runs = Vec::with_capacity(timeline.runs.len());
    for planned in &timeline.runs {
        twin.rest_until(planned.begins_s);
        runs.push(twin.play(planned, &mut ticker)?);
    }
    Ok(Recording {
        scenario: scenario.name.clone(),
        device: scenario.device.clone(),
        columns: scenario.columns.clone(),
        runs,
    })
}

/// Tells how far the simulation is, at every whole percent.
struct Ticker<'a> {
    progress: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
    done_s: f64,
    total_s: f64,
    told: f64,
}

impl Ticker<'_> {
    fn pass(&mut self, dt_s: f64) -> Result<(), SimulateError> {
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

#[cfg(test)]
mod tests;
