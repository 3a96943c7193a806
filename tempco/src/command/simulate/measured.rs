//! A scenario carried out, as every verb that simulates does it.

use crate::failure::Failure;
use crate::output::{Kind, with_mark};
use crate::progress::bar;
use firmware_sim::recording::Recording;
use firmware_sim::scenario::Scenario;
use firmware_sim::simulation;
use std::ops::ControlFlow;

/// A built-in scenario by name, or a file.
pub fn scenario(name: &str) -> Result<Scenario, Failure> {
    if let Some(scenario) = Scenario::preset(name) {
        return Ok(scenario);
    }
    let text = std::fs::read_to_string(name).map_err(|error| {
        Failure::new(format_args!("{name}: {error}"))
            .help("`tempco simulate` lists the built-in scenarios; anything else must be a scenario file")
    })?;
    Scenario::from_toml(&text).map_err(|error| Failure::new(format_args!("{name}: {error}")))
}

/// Carries out a scenario with a progress bar.
pub fn simulate(scenario: &Scenario, seed: u64) -> Result<Recording, Failure> {
    let bar = bar(100, "measuring");
    let recording = simulation::simulate(scenario, seed, &mut |done| {
        bar.set_position((done * 100.0) as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    recording.map_err(Failure::new)
}

/// The campaign as one CSV file, with the mark by which tempco knows it again.
pub fn written(recording: &Recording) -> Result<Vec<u8>, Failure> {
    let mut table = Vec::new();
    recording.write_csv(&mut table).map_err(Failure::new)?;
    Ok(with_mark(Kind::Campaign, &table))
}
