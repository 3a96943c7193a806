//! What the laboratory does: the device, the rig, the effects and the runs, as a file that a person writes.
//!
//! Apart from the twin because a scenario is data: it can be checked, changed and blinded without simulating anything.

use serde::{Deserialize, Serialize};

use crate::recording::Column;
use crate::scenario::limit::{Fault, within};
use crate::scenario::timeline::Timeline;
use crate::twin::effect::Effects;
use crate::twin::noise::Noise;
use crate::twin::truth::Truth;

mod blind;
pub mod kind;
pub mod limit;
pub mod position;
mod preset;
pub mod programme;
mod rig;
mod run;
pub mod timeline;

pub use blind::{BlindError, BlindOptions};
pub(crate) use rig::ARCSEC;
pub use rig::Rig;
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
        Ok(Timeline::of(self, 0)?.rows(self.step_s))
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
        self.effects.check()?;
        for run in &self.run {
            run.check().map_err(part(&format!("run `{}`", run.common.name)))?;
        }
        Timeline::of(self, 0).map(|_| ())
    }
}

/// Why a scenario cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The text is not a scenario; the message shows the line.
    #[error("this is not a scenario: {0}")]
    Toml(Box<toml::de::Error>),
    /// A number that cannot be.
    #[error("in {part}: {fault}")]
    Part {
        /// The part of the scenario.
        part: String,
        /// The number.
        fault: Fault,
    },
    /// Nothing to do.
    #[error("the scenario has no run; add at least one `[[run]]` with a `name` and a `kind`")]
    NoRun,
    /// Two runs of one name.
    #[error("two runs are named `{name}`; give every run a name of its own")]
    SameName {
        /// The name.
        name: String,
    },
    /// A run that begins while another goes on.
    #[error(
        "run `{run}` begins at age {begins_days} days, but the run before it ends at {ends_days:.4} days; \
         state a later `age_days`, or none to let it follow after the rig's `pause_h`"
    )]
    Overlap {
        /// The run that begins too early.
        run: String,
        /// When it begins, days.
        begins_days: f64,
        /// When the run before it ends, days.
        ends_days: f64,
    },
    /// A run of which no sample would be kept.
    #[error("run `{run}` keeps no sample of a part that lasts {part_s} s; lower `record_every_s` to at most that")]
    KeepsNothing {
        /// The run.
        run: String,
        /// The length of the part, s.
        part_s: f64,
    },
    /// A campaign that no memory holds.
    #[error("the scenario asks for {rows} samples and more; {limit} is the limit, so raise `record_every_s`")]
    TooManyRows {
        /// Samples asked for.
        rows: u64,
        /// Samples allowed.
        limit: u64,
    },
    /// A campaign that takes for ever.
    #[error("the scenario goes through {steps} time steps and more; {limit} is the limit, so raise `step_s`")]
    TooManySteps {
        /// Steps asked for.
        steps: u64,
        /// Steps allowed.
        limit: u64,
    },
    /// More poses than anybody writes down.
    #[error(
        "the runs have {parts} parts and more; {limit} is the limit, so shorten their lists, or `repeat` them less"
    )]
    TooManyParts {
        /// Parts asked for.
        parts: usize,
        /// Parts allowed.
        limit: usize,
    },
}

#[cfg(test)]
mod tests;
