//! One `[[run]]` of a scenario: what every kind has in common, and the kind itself.
//!
//! Read in two passes, because serde cannot refuse unknown keys and flatten at once, and a misspelt key must not pass.

use serde::{Deserialize, Serialize};

use crate::limit::{CHAMBER_C, Fault, LONGEST_S, positive, up_to, within};
use crate::scenario::kind::Kind;
use crate::scenario::programme::Segment;

/// What every run states besides its kind. All but the name may be left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Common {
    /// Name of the run, unique in the scenario. A repeated run gets `-1`, `-2` … appended.
    pub name: String,
    /// How often the run is repeated, one pause after the other.
    #[serde(default = "once")]
    pub repeat: u32,
    /// Age of the device when the (first) run begins, days; without it the run follows after the rig's pause.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub age_days: Option<f64>,
    /// Time between kept samples, s. Every kept sample is that of one gate of the counter, not a mean.
    #[serde(default = "every_second")]
    pub record_every_s: f64,
    /// Turn of the device about its input axis when it was mounted, 0 or 180 degrees.
    #[serde(default)]
    pub mount_rotation_deg: f64,
    /// Warmth of the powered package in this run, instead of the device's, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_heating_k: Option<f64>,
    /// Time constant of that warmth in this run, instead of the device's, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_heating_tau_s: Option<f64>,
    /// States in which the counter was wrong.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bad_state: Vec<BadState>,
}

/// A pose at a node in which the first fork's frequency is wrong, as if the loop had locked to something else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BadState {
    /// The chamber's set point at which it happens, °C.
    pub temperature_c: f64,
    /// The pose in which it happens, degrees.
    pub position_deg: f64,
    /// How wrong the difference frequency is, Hz.
    pub delta_f_hz: f64,
}

impl BadState {
    /// How wrong the first fork is in this segment, Hz.
    pub(crate) fn shift_hz(&self, segment: &Segment) -> f64 {
        let here = segment.to_c == self.temperature_c && segment.position.angle_deg == self.position_deg;
        if here { self.delta_f_hz } else { 0.0 }
    }
}

/// One run of the scenario, or several that are alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "toml::Table", into = "toml::Table")]
pub struct Run {
    /// Name, age, sampling, mounting.
    pub common: Common,
    /// What is done.
    pub kind: Kind,
}

/// The keys of [`Common`]; everything else belongs to the kind.
const COMMON_KEYS: [&str; 8] = [
    "name",
    "repeat",
    "age_days",
    "record_every_s",
    "mount_rotation_deg",
    "self_heating_k",
    "self_heating_tau_s",
    "bad_state",
];

fn once() -> u32 {
    1
}

fn every_second() -> f64 {
    1.0
}

impl TryFrom<toml::Table> for Run {
    type Error = String;

    fn try_from(table: toml::Table) -> Result<Self, String> {
        let (common, kind): (toml::Table, toml::Table) =
            table.into_iter().partition(|(key, _)| COMMON_KEYS.contains(&key.as_str()));
        let name = common.get("name").and_then(toml::Value::as_str).unwrap_or("without a name").to_owned();
        let place = |error: toml::de::Error| format!("in run `{name}`: {}", error.message());
        if !kind.contains_key("kind") {
            return Err(format!("in run `{name}`: no `kind`; it is one of {}", Kind::NAMES.join(", ")));
        }
        Ok(Self { common: common.try_into().map_err(place)?, kind: kind.try_into().map_err(place)? })
    }
}

impl From<Run> for toml::Table {
    fn from(run: Run) -> Self {
        // Both are plain structures of numbers, strings and lists: they always have a table form.
        let table = |value: Result<toml::Table, toml::ser::Error>| value.unwrap_or_default();
        let mut all = table(toml::Table::try_from(run.common));
        all.extend(table(toml::Table::try_from(run.kind)));
        all
    }
}

impl Run {
    /// # Errors
    /// The first number that cannot be carried out.
    pub fn check(&self) -> Result<(), Fault> {
        let common = &self.common;
        if common.name.is_empty() {
            return Err(Fault::new("name", &"empty", "a name that no other run has"));
        }
        within("repeat", f64::from(common.repeat), 1.0, 1000.0)?;
        common.age_days.map_or(Ok(()), |age| within("age_days", age, 0.0, 1e5))?;
        up_to("record_every_s", common.record_every_s, LONGEST_S)?;
        if common.mount_rotation_deg != 0.0 && common.mount_rotation_deg != 180.0 {
            return Err(Fault::new("mount_rotation_deg", &common.mount_rotation_deg, "0 or 180"));
        }
        common.self_heating_k.map_or(Ok(()), |rise| within("self_heating_k", rise, 0.0, 50.0))?;
        common.self_heating_tau_s.map_or(Ok(()), |tau| positive("self_heating_tau_s", tau))?;
        for bad in &common.bad_state {
            within("bad_state.delta_f_hz", bad.delta_f_hz, -1e4, 1e4)?;
            within("bad_state.temperature_c", bad.temperature_c, CHAMBER_C.0, CHAMBER_C.1)?;
            within("bad_state.position_deg", bad.position_deg, -360.0, 360.0)?;
        }
        self.kind.check()
    }

    /// The name of the repetition `index`, from 0.
    #[must_use]
    pub fn name(&self, index: u32) -> String {
        if self.common.repeat == 1 { self.common.name.clone() } else { format!("{}-{}", self.common.name, index + 1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Run, String> {
        text.parse::<toml::Table>().map_err(|e| e.to_string()).and_then(Run::try_from)
    }

    #[test]
    fn what_is_left_out_is_the_papers_test() {
        let run = read("name = 'a'\nkind = 'full'").unwrap();
        assert_eq!((run.common.repeat, run.common.record_every_s, run.common.age_days), (1, 1.0, None));
        let Kind::Full(full) = &run.kind else { panic!("{run:?}") };
        assert_eq!((full.nodes_c.len(), full.soak_s, full.dwell_s), (6, 3600.0, 30.0));
    }

    #[test]
    fn a_run_survives_writing_and_reading() {
        let text = "name = 'a'\nkind = 'tumble'\nage_days = 3.5\npositions = 12\norder = 'listed'";
        let run = read(text).unwrap();
        assert_eq!(Run::try_from(toml::Table::from(run.clone())).unwrap(), run);
    }

    #[test]
    fn mistakes_are_named_with_their_run() {
        for (text, expected) in [
            ("name = 'a'", "in run `a`: no `kind`; it is one of full, zero, ramp"),
            ("name = 'a'\nkind = 'full'\nsoak_h = 1", "in run `a`: unknown field `soak_h`"),
            ("name = 'a'\nkind = 'bake'", "in run `a`: unknown variant `bake`, expected one of `full`"),
            ("kind = 'full'", "missing field `name`"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
