//! A campaign as it would have been measured: the twin goes through a scenario.

use std::ops::ControlFlow;

use crate::recording::Recording;
use crate::scenario::Scenario;

mod error;
mod play;
mod ticker;

pub use error::SimulateError;
use play::Twin;
use ticker::Ticker;

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
    let timeline = scenario.timeline(seed)?;
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

#[cfg(test)]
mod tests;
