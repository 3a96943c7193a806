//! The recordings that a laboratory with chamber and turntable can make, laid out for one campaign.
//!
//! A recording is a scenario; the twin without noise, errors and effects carries it out, as a model of chamber and
//! turntable: what matters is when which temperature, position and supply is there.

use firmware_sim::recording::{Column, RecordedRun, Row as Recorded};
use firmware_sim::scenario::Run as ScenarioRun;
use firmware_sim::scenario::Scenario;
use firmware_sim::simulation;
use firmware_sim::twin::Noise;
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use trainer::campaign::{Campaign, Quantity, Row, Run};
use trainer::diagnose::plan::Recording;

use crate::failure::Failure;
use protocol::Sample;

/// What can be recorded; `{cold}` to `{hot}` stand for the campaign's temperatures.
const TEXTS: [&str; 13] = [
    include_str!("../recordings/two-rate-ramp.toml"),
    include_str!("../recordings/fast-ramp.toml"),
    include_str!("../recordings/ramp-under-load.toml"),
    include_str!("../recordings/nodes-up-and-down.toml"),
    include_str!("../recordings/power-cycles.toml"),
    include_str!("../recordings/tumble-two-mountings.toml"),
    include_str!("../recordings/resting-tumble.toml"),
    include_str!("../recordings/supply-sweep.toml"),
    include_str!("../recordings/vibration-sweep.toml"),
    include_str!("../recordings/pressure-sweep.toml"),
    include_str!("../recordings/humidity-steps.toml"),
    include_str!("../recordings/long-soak.toml"),
    include_str!("../recordings/long-checks.toml"),
];

/// The twin's columns that are auxiliary channels of a campaign.
const CHANNELS: [Column; 5] =
    [Column::CrossG, Column::SupplyV, Column::VibrationG2, Column::PressurePa, Column::HumidityPct];

/// A recording and the scenario that makes it.
pub struct Proposed {
    pub scenario: Scenario,
    pub recording: Recording,
}

/// All recordings for this campaign. They follow after it, in its range of temperatures, with its columns; other columns
/// in `wanted` are added where a recording changes what they hold.
pub fn all(campaign: &Campaign, wanted: &[&str]) -> Result<Vec<Proposed>, Failure> {
    let place = Place::of(campaign);
    TEXTS.iter().map(|text| place.lay_out(text, campaign, wanted)).collect()
}

/// The scenario as a file: what is to be done, every number stated, and nothing about the device.
pub fn text(scenario: &Scenario) -> String {
    #[derive(Serialize)]
    struct Programme<'a> {
        name: &'a str,
        description: &'a str,
        columns: &'a [Column],
        run: &'a [ScenarioRun],
    }
    let Scenario { name, description, columns, run, .. } = scenario;
    // Numbers, strings, lists and tables only: serialising cannot fail.
    toml::to_string_pretty(&Programme { name, description, columns, run }).unwrap_or_default()
}

/// Where a campaign leaves off.
struct Place {
    /// Its temperatures from the coldest to the hottest in quarters, whole °C.
    temperatures_c: [f64; 5],
    /// Age of the sensor when the next recording can begin, days.
    age_days: f64,
    /// What names of new runs begin with: no run of the campaign does.
    prefix: String,
}

impl Place {
    fn of(campaign: &Campaign) -> Self {
        let temperatures = campaign.rows().map(|row| f64::from(row.sample.temperature_uc) * 1e-6);
        let (cold, hot) = temperatures.fold((f64::MAX, f64::MIN), |(cold, hot), c| (cold.min(c), hot.max(c)));
        let age_s = campaign.rows().filter_map(|row| row.sample.age_s).max().unwrap_or(0);
        let is_new = |prefix: &String| !campaign.runs.iter().any(|run| run.name.starts_with(prefix.as_str()));
        Self {
            temperatures_c: [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| (cold + part * (hot - cold)).round()),
            age_days: (f64::from(age_s) / DAY_S).ceil() + 1.0,
            prefix: (1..).map(|number| format!("plan{number}-")).find(is_new).unwrap_or_default(),
        }
    }

    fn lay_out(&self, text: &str, campaign: &Campaign, wanted: &[&str]) -> Result<Proposed, Failure> {
        let mut text = text.to_owned();
        for (name, temperature_c) in ["{cold}", "{cool}", "{mid}", "{warm}", "{hot}"].iter().zip(self.temperatures_c) {
            text = text.replace(name, &format!("{temperature_c}"));
        }
        let mut scenario = Scenario::from_toml(&text).map_err(Failure::new)?;
        scenario.columns = columns(campaign, &scenario.columns, wanted);
        for (index, run) in scenario.run.iter_mut().enumerate() {
            let common = &mut run.common;
            common.name = format!("{}{}", self.prefix, common.name);
            common.age_days = common.age_days.or((index == 0).then_some(0.0)).map(|days| days + self.age_days);
        }
        let recording = planned(&scenario, campaign)?;
        Ok(Proposed { scenario, recording })
    }
}

const DAY_S: f64 = 86_400.0;

/// The campaign's own columns as far as chamber and turntable know them, and what is wanted beside.
fn columns(campaign: &Campaign, own: &[Column], wanted: &[&str]) -> Vec<Column> {
    let mut columns = vec![Column::PowerOnS];
    let needed = |column: &Column| own.contains(column) && wanted.contains(&column.name());
    if campaign.rows().any(|row| row.sample.age_s.is_some()) || needed(&Column::AgeDays) {
        columns.push(Column::AgeDays);
    }
    if campaign.rows().any(|row| row.sample.sum_f_uhz.is_some()) {
        columns.extend([Column::F1Hz, Column::F2Hz]);
    }
    let recorded = |column: &Column| campaign.channels.iter().any(|name| name == column.name());
    columns.extend(CHANNELS.into_iter().filter(|column| recorded(column) || needed(column)));
    columns
}

/// What the recording would be, row by row.
fn planned(scenario: &Scenario, campaign: &Campaign) -> Result<Recording, Failure> {
    let quiet = Scenario { noise: Noise::off(), ..scenario.clone() };
    let recording = simulation::simulate(&quiet, 1, &mut |_| ControlFlow::Continue(())).map_err(Failure::new)?;
    let timeline = quiet.timeline(1).map_err(Failure::new)?;
    let ends_s = timeline.runs.last().map_or(0.0, |run| run.begins_s + run.duration_s());
    let begins_s = timeline.runs.first().map_or(0.0, |run| run.begins_s);
    let channels: Vec<Column> = CHANNELS.into_iter().filter(|column| scenario.columns.contains(column)).collect();
    let names = channels.iter().map(|column| column.name().to_owned()).collect();
    let aged = scenario.columns.contains(&Column::AgeDays);
    let runs = recording.runs.iter().map(|run| as_run(run, &channels, aged)).collect();
    let quantity = Quantity { signal_unit: campaign.quantity.signal_unit.clone(), ..Quantity::default() };
    Ok(Recording {
        name: scenario.name.clone(),
        campaign: Campaign::new(runs, names, quantity),
        hours: timeline.duration_s() / 3600.0,
        days: (ends_s - begins_s) / DAY_S,
    })
}

fn as_run(run: &RecordedRun, channels: &[Column], aged: bool) -> Run {
    let rows = run.rows.iter().map(|row| as_row(row, channels, aged)).collect();
    Run { name: run.name.clone(), kind: run.kind.clone(), source: PathBuf::new(), rows }
}

fn as_row(row: &Recorded, channels: &[Column], aged: bool) -> Row {
    let micro = |value: f64| (value * 1e6).round();
    let mut sample = Sample::from_pair(
        micro(row.time_s) as u64,
        micro(row.f1_hz) as u64,
        micro(row.f2_hz) as u64,
        micro(row.temperature_c) as i32,
    );
    sample.power_on_us = micro(row.power_on_s) as u64;
    sample.age_s = aged.then_some((row.age_days * DAY_S).round() as u32);
    for (slot, column) in sample.channels.iter_mut().zip(channels) {
        *slot = micro(value(row, *column)) as i64;
    }
    Row { sample, reference_g: row.reference_g, reference_sigma_g: None }
}

fn value(row: &Recorded, column: Column) -> f64 {
    match column {
        Column::CrossG => row.cross_g,
        Column::SupplyV => row.supply_v,
        Column::VibrationG2 => row.vibration_g2,
        Column::PressurePa => row.pressure_pa,
        Column::HumidityPct => row.humidity_pct,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::campaign::ReadOptions;

    #[test]
    fn every_recording_can_be_made_and_its_text_is_a_scenario() {
        let small = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.csv"));
        let campaign = Campaign::read(&[small], &ReadOptions::default()).expect("checked in");
        for Proposed { scenario, recording } in all(&campaign, &["supply_v"]).expect("all can be laid out") {
            let again = Scenario::from_toml(&text(&scenario)).expect("a scenario");
            assert_eq!((&again.run, &again.columns), (&scenario.run, &scenario.columns), "{}", scenario.name);
            assert!(recording.hours > 0.5 && recording.campaign.row_count() > 100, "{}", scenario.name);
            assert_eq!(recording.campaign.channels.len(), usize::from(scenario.name == "supply-sweep"));
        }
    }
}
