//! A small campaign, what the chain says of it, and when two answers are the same.

use firmware_sim::blind::{BlindOptions, blinded};
use firmware_sim::scenario::Scenario;
use firmware_sim::simulation::simulate;
use std::ops::ControlFlow;
use tempfile::TempDir;
use trainer::campaign::{Campaign, HoldOut, Quantity, ReadOptions, Row};
use trainer::compare::compare;
use trainer::diagnose::{Diagnosis, diagnose};
use trainer::progress::Quiet;
use trainer::train::{EffectChoice, TrainSettings, train};

const SHORT: &str = include_str!("../scenarios/short.toml");

/// A campaign in which these effects are hidden, each about five times the noise.
pub fn measured(hidden: &[&str], seed: u64) -> Campaign {
    let mut scenario = Scenario::from_toml(SHORT).expect("a scenario");
    for name in hidden {
        let candidates = vec![(*name).to_owned()];
        let options = BlindOptions { candidates, at_least: 1, at_most: 1, weakest: 4.5, strongest: 5.0 };
        scenario = blinded(&scenario, seed, &options).expect("the scenario excites it").0;
    }
    let recording = simulate(&scenario, seed, &mut |_| ControlFlow::Continue(())).expect("a recording");
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    recording.write_csv(&mut std::fs::File::create(&file).expect("a file")).expect("written");
    Campaign::read(&[file], &ReadOptions::default()).expect("a campaign")
}

/// The campaign with every row changed, its reference in this unit.
pub fn changed(campaign: &Campaign, unit: &str, change: impl Fn(&mut Row)) -> Campaign {
    let mut runs = campaign.runs.clone();
    runs.iter_mut().flat_map(|run| &mut run.rows).for_each(change);
    let quantity = Quantity { reference_unit: unit.to_owned(), ..campaign.quantity.clone() };
    Campaign::new(runs, campaign.channels.clone(), quantity)
}

pub fn scaled(factor: f64) -> impl Fn(&mut Row) {
    move |row: &mut Row| {
        row.reference_g *= factor;
        row.reference_sigma_g = row.reference_sigma_g.map(|sigma| sigma * factor);
    }
}

pub fn settings(effects: Vec<EffectChoice>) -> TrainSettings {
    TrainSettings { restarts: 4, effects, ..TrainSettings::new(1) }
}

/// What the chain says: the residual when trained, the diagnosis, the residual when what was found is in the model.
pub struct Answer {
    pub residual_ug: f64,
    pub diagnosis: Diagnosis,
    pub after_ug: f64,
}

pub fn answer(campaign: &Campaign) -> Answer {
    answer_with(campaign, &HoldOut::LastOfEachKind, &settings(Vec::new()))
}

/// The same with these runs held out and these settings.
pub fn answer_with(campaign: &Campaign, hold_out: &HoldOut, settings: &TrainSettings) -> Answer {
    let split = campaign.split(hold_out).expect("a split");
    let model = train(campaign, &split, settings, &Quiet).expect("a model").model;
    let diagnosis = diagnose(&model, campaign, &Quiet).expect("a diagnosis");
    let effects = diagnosis.findings.iter().map(|finding| EffectChoice::named(&finding.effect)).collect();
    let settings = TrainSettings { effects, ..settings.clone() };
    let better = train(campaign, &split, &settings, &Quiet).expect("a better model").model;
    let residual_ug = |model| compare(model, campaign).expect("a comparison").residual_ug;
    Answer { residual_ug: residual_ug(&model), diagnosis, after_ug: residual_ug(&better) }
}

/// How far figures may differ: another order of the same sums, another start of the same descent.
pub const NEAR: f64 = 0.03;

pub fn near(what: &str, a: f64, b: f64) {
    within(NEAR, what, a, b);
}

pub fn within(part: f64, what: &str, a: f64, b: f64) {
    assert!((a - b).abs() <= part * a.abs().max(b.abs()), "{what}: {a} and {b}");
}

/// `other` is the same answer with the reference in units of 1/`factor`; `power` says how each parameter follows it.
pub fn same(what: &str, one: &Answer, other: &Answer, factor: f64, power: impl Fn(&str) -> i32) {
    alike(what, one, other, &Change { factor, evidence: 1.0, near: NEAR, evidence_near: NEAR }, power);
}

/// What a change of the campaign makes of an answer.
pub struct Change {
    /// Readings are multiplied with this.
    pub factor: f64,
    /// And evidence with this.
    pub evidence: f64,
    /// Within these parts, as another start of the same descent may end beside.
    pub near: f64,
    pub evidence_near: f64,
}

/// `other` is what the change makes of `one`.
pub fn alike(what: &str, one: &Answer, other: &Answer, change: &Change, power: impl Fn(&str) -> i32) {
    let &Change { factor, evidence, near: part, evidence_near } = change;
    let near = |what: &str, a: f64, b: f64| within(part, what, a, b);
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
        within(evidence_near, &format!("{what}: evidence"), a.delta_bic * evidence, b.delta_bic);
        for ((name, a), (other, b)) in a.parameters.iter().zip(&b.parameters) {
            assert_eq!(name, other);
            near(&format!("{what}: {name}"), a.value * factor.powi(power(name)), b.value);
        }
    }
}

/// Campaigns of different character: nothing missing, a lag, a play, a channel.
pub fn campaigns() -> Vec<(&'static str, Campaign)> {
    let lag = ("a lag", measured(&["thermal-lag"], 1));
    let play = ("a play", measured(&["thermal-hysteresis"], 3));
    vec![("nothing", measured(&[], 6)), lag, play]
}

/// Amplitudes in units of the reference follow it, times and widths don't.
pub fn with_reference(parameter: &str) -> i32 {
    i32::from(parameter.contains("_g"))
}
