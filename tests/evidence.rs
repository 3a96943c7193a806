//! How much evidence a diagnosis wants: twice the log-likelihood of 25 beyond the price of the parameters. Less is left
//! unsaid, because noise reaches it now and then; more is not asked for, because small effects never reach it.

use firmware_sim::blind::{BlindOptions, blinded};
use firmware_sim::scenario::Scenario;
use firmware_sim::simulation;
use std::ops::ControlFlow;
use tempfile::TempDir;
use trainer::campaign::{Campaign, HoldOut, ReadOptions};
use trainer::diagnose::{Finding, LEAST_DELTA_BIC, diagnose};
use trainer::progress::Quiet;
use trainer::train::{TrainSettings, train};

const SHORT: &str = include_str!("scenarios/short.toml");

/// What a diagnosis finds where a warm-up of so many times the noise is hidden.
fn findings(times_noise: f64) -> Vec<Finding> {
    let options = BlindOptions {
        candidates: vec!["warm-up".to_owned()],
        at_least: 1,
        at_most: 1,
        weakest: 0.99 * times_noise,
        strongest: times_noise,
    };
    let (scenario, _) =
        blinded(&Scenario::from_toml(SHORT).expect("a scenario"), 3, &options).expect("it can be hidden");
    let recording = simulation::simulate(&scenario, 3, &mut |_| ControlFlow::Continue(())).expect("a recording");
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    recording.write_csv(&mut std::fs::File::create(&file).expect("a file")).expect("written");
    let campaign = Campaign::read(&[file], &ReadOptions::default()).expect("a campaign");
    let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let settings = TrainSettings { restarts: 2, ..TrainSettings::new(1) };
    let model = train(&campaign, &split, &settings, &Quiet).expect("a model").model;
    diagnose(&model, &campaign, &Quiet).expect("a diagnosis").findings
}

#[test]
fn what_noise_could_be_is_not_named() {
    for times_noise in [0.2, 0.25] {
        let named: Vec<_> = findings(times_noise).into_iter().map(|found| (found.effect, found.delta_bic)).collect();
        assert!(named.is_empty(), "{times_noise} times the noise: {named:?}");
    }
}

#[test]
fn a_small_effect_is_named_as_soon_as_noise_could_not_be_it() {
    for times_noise in [0.3, 0.45, 0.6] {
        let found = findings(times_noise);
        let [only] = found.as_slice() else { panic!("{times_noise} times the noise: {found:?}") };
        assert_eq!(only.effect, "warm-up");
        assert!(
            (LEAST_DELTA_BIC..150.0).contains(&only.delta_bic),
            "{times_noise} times the noise: {}",
            only.delta_bic
        );
    }
}
