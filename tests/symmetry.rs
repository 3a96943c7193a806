//! What does not change the physics does not change the answer: which fork is called the first, which way up is positive,
//! the unit of the reference, when the clock was started, what the runs are called.
//!
//! The whole chain each time: a campaign is trained on, diagnosed, given what it lacks, and compared.

use firmware_sim::blind::{BlindOptions, blinded};
use firmware_sim::scenario::Scenario;
use firmware_sim::simulation;
use std::ops::ControlFlow;
use tempfile::TempDir;
use trainer::campaign::{Campaign, HoldOut, Quantity, ReadOptions, Row};
use trainer::compare::compare;
use trainer::diagnose::{Diagnosis, diagnose};
use trainer::progress::Quiet;
use trainer::train::{EffectChoice, TrainError, TrainSettings, train};

const SHORT: &str = include_str!("scenarios/short.toml");

/// A campaign in which these effects are hidden, each about five times the noise.
fn measured(hidden: &[&str], seed: u64) -> Campaign {
    let mut scenario = Scenario::from_toml(SHORT).expect("a scenario");
    for name in hidden {
        let candidates = vec![(*name).to_owned()];
        let options = BlindOptions { candidates, at_least: 1, at_most: 1, weakest: 4.5, strongest: 5.0 };
        scenario = blinded(&scenario, seed, &options).expect("the scenario excites it").0;
    }
    let recording = simulation::simulate(&scenario, seed, &mut |_| ControlFlow::Continue(())).expect("a recording");
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    recording.write_csv(&mut std::fs::File::create(&file).expect("a file")).expect("written");
    Campaign::read(&[file], &ReadOptions::default()).expect("a campaign")
}

/// The campaign with every row changed, its reference in this unit.
fn changed(campaign: &Campaign, unit: &str, change: impl Fn(&mut Row)) -> Campaign {
    let mut runs = campaign.runs.clone();
    runs.iter_mut().flat_map(|run| &mut run.rows).for_each(change);
    let quantity = Quantity { reference_unit: unit.to_owned(), ..campaign.quantity.clone() };
    Campaign::new(runs, campaign.channels.clone(), quantity)
}

fn forks_swapped(row: &mut Row) {
    row.sample.delta_f_uhz = -row.sample.delta_f_uhz;
}

fn turned_over(row: &mut Row) {
    row.reference_g = -row.reference_g;
}

fn scaled(factor: f64) -> impl Fn(&mut Row) {
    move |row: &mut Row| {
        row.reference_g *= factor;
        row.reference_sigma_g = row.reference_sigma_g.map(|sigma| sigma * factor);
    }
}

fn settings(effects: Vec<EffectChoice>) -> TrainSettings {
    TrainSettings { restarts: 4, effects, ..TrainSettings::new(1) }
}

/// What the chain says: the residual when trained, the diagnosis, the residual when what was found is in the model.
struct Answer {
    residual_ug: f64,
    diagnosis: Diagnosis,
    after_ug: f64,
}

fn answer(campaign: &Campaign) -> Answer {
    let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let model = train(campaign, &split, &settings(Vec::new()), &Quiet).expect("a model").model;
    let diagnosis = diagnose(&model, campaign, &Quiet).expect("a diagnosis");
    let effects = diagnosis.findings.iter().map(|finding| EffectChoice::named(&finding.effect)).collect();
    let better = train(campaign, &split, &settings(effects), &Quiet).expect("a better model").model;
    let residual_ug = |model| compare(model, campaign).expect("a comparison").residual_ug;
    Answer { residual_ug: residual_ug(&model), diagnosis, after_ug: residual_ug(&better) }
}

/// How far figures may differ: another order of the same sums, another start of the same descent.
const NEAR: f64 = 0.03;

fn near(what: &str, a: f64, b: f64) {
    assert!((a - b).abs() <= NEAR * a.abs().max(b.abs()), "{what}: {a} and {b}");
}

/// `other` is the same answer with the reference in units of 1/`factor`; `power` says how each parameter follows it.
fn same(what: &str, one: &Answer, other: &Answer, factor: f64, power: impl Fn(&str) -> i32) {
    near(what, one.residual_ug * factor.abs(), other.residual_ug);
    near(what, one.after_ug * factor.abs(), other.after_ug);
    let (one, other) = (&one.diagnosis, &other.diagnosis);
    assert_eq!(one.verdict, other.verdict, "{what}: {one:#?} {other:#?}");
    near(what, one.residual_ug * factor.abs(), other.residual_ug);
    near(what, one.noise_floor_ug * factor.abs(), other.noise_floor_ug);
    assert_eq!(one.unobservable, other.unobservable, "{what}");
    assert_eq!(one.findings.len(), other.findings.len(), "{what}: {one:#?} {other:#?}");
    for (a, b) in one.findings.iter().zip(&other.findings) {
        assert_eq!((&a.effect, &a.confounded_with), (&b.effect, &b.confounded_with), "{what}");
        near(what, a.delta_bic, b.delta_bic);
        for ((name, a), (other, b)) in a.parameters.iter().zip(&b.parameters) {
            assert_eq!(name, other);
            near(&format!("{what}: {name}"), a.value * factor.powi(power(name)), b.value);
        }
    }
}

/// Campaigns of different character: nothing missing, a lag, a play, a channel.
fn campaigns() -> Vec<(&'static str, Campaign)> {
    let lag = ("a lag", measured(&["thermal-lag"], 1));
    let play = ("a play", measured(&["thermal-hysteresis"], 3));
    vec![("nothing", measured(&[], 6)), lag, play]
}

/// Amplitudes in units of the reference follow it, times and widths don't.
fn with_reference(parameter: &str) -> i32 {
    i32::from(parameter.contains("_g"))
}

#[test]
fn swapped_forks_and_a_sensor_upside_down_get_the_same_answer() {
    for (what, campaign) in campaigns() {
        let one = answer(&campaign);
        let swapped = changed(&campaign, "g", forks_swapped);
        same(&format!("{what}, swapped"), &one, &answer(&swapped), 1.0, |_| 0);
        let both = changed(&swapped, "g", turned_over);
        same(&format!("{what}, both"), &one, &answer(&both), -1.0, with_reference);
        let over = changed(&campaign, "g", turned_over);
        same(&format!("{what}, turned over"), &one, &answer(&over), -1.0, with_reference);
    }
}

#[test]
fn the_unit_of_the_reference_does_not_matter() {
    for (what, campaign) in campaigns() {
        let one = answer(&campaign);
        for (unit, factor) in [("mg", 1e3), ("µg", 1e6), ("m/s2", 9.806_65)] {
            let other = changed(&campaign, unit, scaled(factor));
            same(&format!("{what} in {unit}"), &one, &answer(&other), factor, with_reference);
        }
    }
}

#[test]
fn a_reference_of_any_size_that_numbers_hold_is_worked_with_and_any_other_refused() {
    let campaign = measured(&["thermal-lag"], 1);
    let [small, large] = [1e-6, 1e6].map(|factor| answer(&changed(&campaign, "N", scaled(factor))));
    same("1e-6 and 1e6", &small, &large, 1e12, with_reference);
    assert_eq!(small.diagnosis.findings[0].effect, "thermal-lag");
    for factor in [1e-45, 1e45, 1e300] {
        let other = changed(&campaign, "N", scaled(factor));
        let split = other.split(&HoldOut::LastOfEachKind).expect("a split");
        let refusal = train(&other, &split, &settings(Vec::new()), &Quiet).map(|_| ()).expect_err("no device holds it");
        assert!(matches!(refusal, TrainError::Numbers), "{refusal}");
    }
}

#[test]
fn of_a_sensor_at_rest_the_stated_scale_factor_is_a_unit() {
    let mut campaign = measured(&["thermal-lag"], 1);
    campaign.runs.retain(|run| run.kind == "ramp" || run.kind == "zero");
    let still = changed(&campaign, "g", |row| row.reference_g = 0.0);
    let at = |hz_per_g: f64| {
        let split = still.split(&HoldOut::LastOfEachKind).expect("a split");
        let settings = TrainSettings { scale_factor_hz_per_g: Some(hz_per_g), ..settings(Vec::new()) };
        let model = train(&still, &split, &settings, &Quiet).expect("a model").model;
        diagnose(&model, &still, &Quiet).expect("a diagnosis")
    };
    let one = at(420.0);
    for factor in [1e-5, 1e3, -1.0] {
        let other = at(420.0 / factor);
        assert_eq!(one.verdict, other.verdict, "{factor}: {one:#?} {other:#?}");
        near("residual", one.residual_ug * f64::abs(factor), other.residual_ug);
        let names = |one: &Diagnosis| one.findings.iter().map(|one| one.effect.clone()).collect::<Vec<_>>();
        assert_eq!(names(&one), names(&other), "{factor}");
    }
}

#[test]
fn clocks_started_years_ago_and_runs_of_other_names_in_another_order_change_nothing() {
    let campaign = measured(&["thermal-lag"], 1);
    let one = answer(&campaign);
    let late = changed(&campaign, "g", |row| row.sample.time_us += 50 * 365 * 86_400 * 1_000_000);
    same("late", &one, &answer(&late), 1.0, |_| 0);
    let mut runs = campaign.runs.clone();
    // The last of each kind stays the last.
    runs.sort_by(|a, b| b.kind.cmp(&a.kind));
    runs.iter_mut().enumerate().for_each(|(index, run)| run.name = format!("r{}", 100 - index));
    let other = Campaign::new(runs, campaign.channels.clone(), campaign.quantity.clone());
    same("other names", &one, &answer(&other), 1.0, |_| 0);
}

#[test]
fn what_a_model_has_is_not_listed_as_unobservable() {
    let campaign = measured(&["supply-voltage"], 4);
    let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let effects = vec![EffectChoice::named("supply-voltage"), EffectChoice::named("second-order")];
    let model = train(&campaign, &split, &settings(effects), &Quiet).expect("a model").model;
    // Another campaign, in which the supply stood still.
    let mut quiet = measured(&[], 6);
    quiet.runs.retain(|run| run.kind != "supply");
    let channel = quiet.channels.iter().position(|name| name == "supply_v").expect("it was recorded");
    let quiet = changed(&quiet, "g", |row| row.sample.channels[channel] = 5_000_000);
    let hidden = |diagnosis: Diagnosis| diagnosis.unobservable.into_iter().map(|one| one.effect).collect::<Vec<_>>();
    let bare = train(&quiet, &quiet.split(&HoldOut::LastOfEachKind).expect("a split"), &settings(Vec::new()), &Quiet);
    let bare = hidden(diagnose(&bare.expect("a model").model, &quiet, &Quiet).expect("a diagnosis"));
    let with = hidden(diagnose(&model, &quiet, &Quiet).expect("a diagnosis"));
    for name in ["supply-voltage", "second-order"] {
        assert!(bare.iter().any(|other| other == name), "{name} {bare:?}");
        assert!(!with.iter().any(|other| other == name), "{name} {with:?}");
    }
}
