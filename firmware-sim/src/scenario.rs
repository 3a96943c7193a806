//! What the laboratory does: the device, the rig, the effects and the runs, as a file that a person writes.
//!
//! Apart from the simulation because a scenario is data: it can be checked and changed without simulating anything.

use serde::{Deserialize, Serialize};

use crate::limit::within;
use crate::recording::Column;
use crate::scenario::timeline::{Lab, Timeline};
use crate::twin::effect::Effects;
use crate::twin::noise::Noise;
use crate::twin::rig::Rig;
use crate::twin::truth::Truth;

mod error;
pub mod kind;
mod preset;
pub mod programme;
mod run;
pub mod timeline;

pub use error::ScenarioError;
pub use run::{BadState, Common, Run};

/// A measurement campaign before it is measured.
///
/// ```
/// let scenario = firmware_sim::scenario::Scenario::from_toml(
///     r#"
///     name = "two ramps"
///     columns = ["f1_hz", "f2_hz"]
///     [effects.thermal-lag]
///     tau_s = 35
///     [[run]]
///     name = "ramp"
///     kind = "ramp"
///     rates_k_per_min = [1, 0.25]
///     record_every_s = 30
///     repeat = 2
///     "#,
/// )?;
/// assert_eq!(scenario.run.len(), 1);
/// # Ok::<(), firmware_sim::scenario::ScenarioError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name of the campaign.
    pub name: String,
    /// What it is for, in a sentence.
    #[serde(default)]
    pub description: String,
    /// The optional columns that the recording carries, besides run, kind, time, temperature, difference frequency and
    /// reference.
    #[serde(default)]
    pub columns: Vec<Column>,
    /// Time step of the simulation, s.
    #[serde(default = "one_second")]
    pub step_s: f64,
    /// The device.
    #[serde(default)]
    pub device: Truth,
    /// The laboratory.
    #[serde(default)]
    pub rig: Rig,
    /// The noise of device and instrument.
    #[serde(default)]
    pub noise: Noise,
    /// The effects that are switched on.
    #[serde(default)]
    pub effects: Effects,
    /// The runs, in the order of the calendar.
    pub run: Vec<Run>,
}

fn one_second() -> f64 {
    1.0
}

impl Scenario {
    /// # Errors
    /// Unless the text is a scenario that can be carried out; the error names the place and what is accepted there.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let scenario: Self = toml::from_str(text).map_err(|error| ScenarioError::Toml(Box::new(error)))?;
        scenario.check()?;
        Ok(scenario)
    }

    /// The scenario as a file that [`Scenario::from_toml`] reads back.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Numbers, strings, lists and tables only: serialising cannot fail.
        toml::to_string_pretty(self).unwrap_or_default()
    }

    /// A built-in scenario, or `None` if there is none of that name.
    #[must_use]
    pub fn preset(name: &str) -> Option<Self> {
        preset::text(name).and_then(|text| Self::from_toml(text).ok())
    }

    /// The names of the built-in scenarios.
    pub fn preset_names() -> impl Iterator<Item = &'static str> {
        preset::names()
    }

    /// The text of a built-in scenario, as a pattern for one's own.
    #[must_use]
    pub fn preset_toml(name: &str) -> Option<&'static str> {
        preset::text(name)
    }

    /// How many samples the campaign will have.
    ///
    /// # Errors
    /// If the runs cannot be laid out on the calendar.
    pub fn rows(&self) -> Result<u64, ScenarioError> {
        Ok(self.timeline(0)?.rows(self.step_s))
    }

    /// The runs on the calendar; `seed` decides the random orders.
    ///
    /// # Errors
    /// If the runs cannot be laid out on the calendar.
    pub fn timeline(&self, seed: u64) -> Result<Timeline<'_>, ScenarioError> {
        Timeline::of(&self.run, Lab { device: &self.device, rig: &self.rig, step_s: self.step_s }, seed)
    }

    /// # Errors
    /// The first number that cannot be carried out, and the part of the scenario in which it stands.
    pub fn check(&self) -> Result<(), ScenarioError> {
        let part = |part: &str| {
            let part = part.to_owned();
            move |fault| ScenarioError::Part { part, fault }
        };
        within("step_s", self.step_s, 0.01, 60.0).map_err(part("the scenario"))?;
        self.device.check().map_err(part("[device]"))?;
        self.rig.check().map_err(part("[rig]"))?;
        self.noise.check().map_err(part("[noise]"))?;
        self.effects.check().map_err(|(name, fault)| part(&format!("[effects.{name}]"))(fault))?;
        for run in &self.run {
            run.check().map_err(part(&format!("run `{}`", run.common.name)))?;
        }
        self.timeline(0).map(|_| ())
    }
}

#[cfg(test)]
mod tests;
