//! What does not change the physics does not change the answer: which fork is called the first, which way up is positive,
//! the units of signal and reference, when the clock was started, what the runs are called, whether a file was read twice.
//!
//! The whole chain each time: a campaign is trained on, diagnosed, given what it lacks, and compared.

#[path = "symmetry/chain.rs"]
mod chain;
#[path = "symmetry/drift.rs"]
mod drift;
#[path = "symmetry/signal.rs"]
mod signal;
#[path = "symmetry/twice.rs"]
mod twice;

use chain::{answer, campaigns, changed, measured, near, same, scaled, settings, with_reference};
use trainer::campaign::{Campaign, HoldOut, Row};
use trainer::cross_validation::cross_validate;
use trainer::diagnose::{Diagnosis, diagnose};
use trainer::progress::Quiet;
use trainer::train::{EffectChoice, TrainError, TrainSettings, train};

fn forks_swapped(row: &mut Row) {
    row.sample.delta_f_uhz = -row.sample.delta_f_uhz;
}

fn turned_over(row: &mut Row) {
    row.reference_g = -row.reference_g;
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
fn what_is_left_out_to_cross_validate_is_the_same_in_any_unit() {
    let campaign = measured(&[], 6);
    let left_out = |unit: &str, factor: f64| {
        let campaign = changed(&campaign, unit, scaled(factor));
        let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
        cross_validate(&campaign, &split, &TrainSettings { restarts: 1, ..settings(Vec::new()) }).expect("trained")
    };
    let one = left_out("g", 1.0);
    // −1 to 1 g by sines: −0.5, 0 and 0.5 are inner levels, and 210° is at −0.5 as 330° is.
    assert!(one.by_level.len() >= 2, "{one:?}");
    for (unit, factor) in [("µg", 1e6), ("kN", 1e-3)] {
        let other = left_out(unit, factor);
        assert_eq!(one.by_level.len(), other.by_level.len(), "{unit}");
        for (a, b) in one.by_level.iter().zip(&other.by_level) {
            assert_eq!(a.samples, b.samples, "{unit}");
            assert!((a.at * factor - b.at).abs() < 1e-9 * factor, "{unit}: {a:?} {b:?}");
            near(unit, a.residual_ug * factor, b.residual_ug);
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
