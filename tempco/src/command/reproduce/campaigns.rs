//! Tables 1 and 2: simulates the campaigns, trains every method once per set of training runs, judges all of them.

use super::extent::Extent;
use crate::command::simulate;
use crate::failure::Failure;
use crate::output::Kind;
use crate::progress::{Restarts, bar};
use firmware_sim::recording::Recording;
use firmware_sim::scenario::Scenario;
use firmware_sim::twin::StaticMap;
use firmware_sim::twin::effect::Effects;
use protocol::Sample;
use std::ops::ControlFlow;
use std::path::PathBuf;
use trainer::campaign::{Campaign, HoldOut, Quantity, ReadOptions, Row, Run, Split};
use trainer::reproduction::column::{COLUMNS, Column, DEFAULT};
use trainer::reproduction::judgement::Judgement;
use trainer::reproduction::lesson::Lesson;
use trainer::reproduction::paper::TEST_RUNS;
use trainer::reproduction::shortfall::{Perfection, Shortfall, shortfalls};
use trainer::reproduction::truth::Truth;
use trainer::train::Trained;

/// The paper's campaign, then the two readings of what it prints for test data set 1.
const SCENARIOS: [&str; 3] = ["seed", "seed-a2", "seed-a1"];
/// Campaigns with other seeds, to see how much of a figure is chance.
const OTHERS: u64 = 20;

/// One campaign with everything that is said about it.
pub struct Judged {
    pub scenario: Scenario,
    /// The columns of the tables: raw, the methods, polynomial, perfect static map.
    pub columns: Vec<Judgement>,
    /// Where the default is above the paper's IFA-BP.
    pub shortfalls: Vec<Shortfall>,
    /// The campaign that the methods were trained on, when its training runs are the same.
    pub trained_on: Option<String>,
}

/// The simulated sensor's truth.
struct Map(StaticMap);

impl Truth for Map {
    fn delta_f_hz(&self, acceleration_g: f64, temperature_c: f64) -> f64 {
        self.0.delta_f_hz(acceleration_g, temperature_c)
    }

    fn acceleration_g(&self, delta_f_hz: f64, temperature_c: f64) -> f64 {
        self.0.acceleration_g(delta_f_hz, temperature_c)
    }
}

/// What was learnt from one set of training runs.
struct Taught {
    scenario: String,
    lessons: Vec<Run>,
    trained: Vec<(Column, Trained)>,
}

/// What is written of them.
pub fn files() -> impl Iterator<Item = String> {
    SCENARIOS.into_iter().map(file)
}

fn file(scenario: &str) -> String {
    format!("{scenario}.csv")
}

/// Judges every method on every campaign.
pub fn judge(extent: &Extent, files: &mut Vec<PathBuf>) -> Result<Vec<Judged>, Failure> {
    let mut taught: Vec<Taught> = Vec::new();
    let mut judged = Vec::new();
    for name in SCENARIOS {
        let scenario = Scenario::preset(name).ok_or_else(|| Failure::new(format_args!("no scenario named {name}")))?;
        let recording = simulate::simulate(&scenario, extent.seed)?;
        let file = file(name);
        extent.place(&file, Kind::Campaign).write(&simulate::written(&recording)?)?;
        let path = extent.path(file);
        let campaign = Campaign::read(std::slice::from_ref(&path), &ReadOptions::default())?;
        files.push(path);
        let split = campaign.split(&HoldOut::Named(TEST_RUNS.map(str::to_owned).to_vec()))?;
        let lessons: Vec<Run> = split.training.iter().map(|&index| campaign.runs[index].clone()).collect();
        let known = taught.iter().position(|taught| same_rows(&taught.lessons, &lessons));
        let index = known.unwrap_or(taught.len());
        if known.is_none() {
            let trained = teach(extent, &campaign, &split)?;
            taught.push(Taught { scenario: name.to_owned(), lessons, trained });
        }
        let trained_on = known.map(|index| taught[index].scenario.clone());
        let columns = columns(&taught[index].trained, &campaign, &Map(recording.static_map()))?;
        let shortfalls = match columns.iter().find(|column| column.name == DEFAULT) {
            Some(default) => shortfalls(default, &perfection(&scenario, extent.seed)?),
            None => Vec::new(),
        };
        judged.push(Judged { scenario, columns, shortfalls, trained_on });
    }
    Ok(judged)
}

/// Where the files lie does not matter.
fn same_rows(a: &[Run], b: &[Run]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.name == b.name && a.rows == b.rows)
}

fn teach(extent: &Extent, campaign: &Campaign, split: &Split) -> Result<Vec<(Column, Trained)>, Failure> {
    let learn = |column: Column| {
        let progress = Restarts::new(extent.restarts, column.name);
        let Extent { restarts, passes, seed, .. } = *extent;
        let lesson = Lesson { campaign, split, restarts, passes, seed, progress: &progress };
        Ok((column, (column.train)(&lesson)?))
    };
    COLUMNS.into_iter().map(learn).collect()
}

fn columns(trained: &[(Column, Trained)], campaign: &Campaign, truth: &Map) -> Result<Vec<Judgement>, Failure> {
    let (_, default) = trained
        .iter()
        .find(|(column, _)| column.name == DEFAULT)
        .ok_or_else(|| Failure::new("no column is the default method"))?;
    let mut columns = vec![Judgement::raw(default, campaign, truth)?];
    for (column, trained) in trained {
        columns.push(Judgement::trained(column.name, trained, campaign, truth)?);
    }
    columns.push(Judgement::polynomial(default, campaign, truth)?);
    columns.push(Judgement::perfect(campaign, truth)?);
    Ok(columns)
}

/// What the perfect static map leaves: here, on other campaigns, and without each of the things that disturb it.
fn perfection(scenario: &Scenario, seed: u64) -> Result<Perfection, Failure> {
    let without = variants(scenario);
    let bar = bar(1 + OTHERS + without.len() as u64, "judging");
    let perfect = |scenario: &Scenario, seed: u64| {
        bar.inc(1);
        let recording = firmware_sim::simulation::simulate(scenario, seed, &mut |_| ControlFlow::Continue(()))
            .map_err(Failure::new)?;
        Ok::<_, Failure>(Judgement::perfect(&in_memory(&recording), &Map(recording.static_map()))?)
    };
    let perfection = Perfection {
        here: perfect(scenario, seed)?,
        elsewhere: (1..=OTHERS).map(|other| perfect(scenario, seed.wrapping_add(other))).collect::<Result<_, _>>()?,
        without: without
            .into_iter()
            .map(|(name, scenario)| Ok((name, perfect(&scenario, seed)?)))
            .collect::<Result<_, Failure>>()?,
    };
    bar.finish_and_clear();
    Ok(perfection)
}

/// The scenario with one of its effects, its rig's errors or its bad states taken out.
fn variants(scenario: &Scenario) -> Vec<(String, Scenario)> {
    let mut variants: Vec<(String, Scenario)> = scenario
        .effects
        .active()
        .into_iter()
        .map(|name| {
            (format!("the effect `{name}`"), Scenario { effects: lacking(&scenario.effects, name), ..scenario.clone() })
        })
        .collect();
    let rig = scenario.rig.without_errors();
    variants.push(("the errors of table, mounting and nodes".to_owned(), Scenario { rig, ..scenario.clone() }));
    if scenario.run.iter().any(|run| !run.common.bad_state.is_empty()) {
        let mut good = scenario.clone();
        good.run.iter_mut().for_each(|run| run.common.bad_state.clear());
        variants.push(("the bad state".to_owned(), good));
    }
    variants
}

fn lacking(effects: &Effects, name: &str) -> Effects {
    let mut table = toml::Table::try_from(effects).unwrap_or_default();
    table.remove(name);
    table.try_into().unwrap_or_default()
}

/// The recording as a campaign, without a file between.
fn in_memory(recording: &Recording) -> Campaign {
    let micro = |value: f64| (value * 1e6).round();
    let row = |row: &firmware_sim::recording::Row| Row {
        sample: Sample {
            power_on_us: micro(row.power_on_s) as u64,
            ..Sample::from_difference(
                micro(row.time_s) as u64,
                micro(row.delta_f_hz) as i64,
                micro(row.temperature_c) as i32,
            )
        },
        reference_g: row.reference_g,
        reference_sigma_g: None,
    };
    let run = |run: &firmware_sim::recording::RecordedRun| Run {
        name: run.name.clone(),
        kind: run.kind.clone(),
        source: PathBuf::new(),
        rows: run.rows.iter().map(row).collect(),
    };
    Campaign::new(recording.runs.iter().map(run).collect(), Vec::new(), Quantity::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_variant_lacks_one_thing_and_no_other() {
        let scenario = Scenario::preset("seed-a2").expect("a scenario");
        let all = scenario.effects.active();
        assert!(all.len() > 1, "{all:?}");
        let variants = variants(&scenario);
        assert_eq!(variants.len(), all.len() + 2);
        for (name, (title, variant)) in all.iter().zip(&variants) {
            assert_eq!(*title, format!("the effect `{name}`"));
            let left: Vec<&str> = all.iter().copied().filter(|other| other != name).collect();
            assert_eq!(variant.effects.active(), left);
            assert_eq!(variant.rig, scenario.rig);
        }
        let [(_, no_errors), (_, good)] = &variants[all.len()..] else { panic!("two more") };
        assert!(no_errors.rig == scenario.rig.without_errors() && no_errors.rig != scenario.rig);
        assert!(no_errors.effects.active() == all && good.effects.active() == all && good.rig == scenario.rig);
        assert!(good.run.iter().all(|run| run.common.bad_state.is_empty()));
        assert!(no_errors.run == scenario.run && good.run != scenario.run);
    }

    #[test]
    fn the_truth_is_the_simulated_sensors_own_map_there_and_back() {
        let recording = simulate::simulate(&Scenario::preset("seed").expect("a scenario"), 1).expect("a recording");
        let map = Map(recording.static_map());
        for (acceleration_g, temperature_c) in [(-1.0, -40.0), (0.0, 20.0), (0.5, 60.0)] {
            let delta_f_hz = map.delta_f_hz(acceleration_g, temperature_c);
            assert!((map.acceleration_g(delta_f_hz, temperature_c) - acceleration_g).abs() < 1e-9);
        }
        assert!(map.delta_f_hz(1.0, 20.0) - map.delta_f_hz(0.0, 20.0) > 10.0);

        let campaign = in_memory(&recording);
        let (rows, first) = (&campaign.runs[0].rows, &recording.runs[0].rows);
        assert_eq!((campaign.runs.len(), rows.len()), (recording.runs.len(), first.len()));
        for (row, recorded) in rows.iter().zip(first) {
            let near = |micro: f64, value: f64| (micro - value * 1e6).abs() <= 0.5;
            assert!(
                near(row.sample.time_us as f64, recorded.time_s)
                    && near(row.sample.delta_f_uhz as f64, recorded.delta_f_hz)
            );
            assert!(near(f64::from(row.sample.temperature_uc), recorded.temperature_c));
            assert!(
                near(row.sample.power_on_us as f64, recorded.power_on_s) && row.reference_g == recorded.reference_g
            );
        }
        assert!(same_rows(&campaign.runs, &campaign.runs.clone()));
        assert!(
            !same_rows(&campaign.runs[..1], &campaign.runs[1..2]) && !same_rows(&campaign.runs, &campaign.runs[1..])
        );
    }
}
