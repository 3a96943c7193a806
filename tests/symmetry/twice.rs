//! Every row twice. The same run under two names is the same evidence twice, so the findings are the same, their evidence
//! is doubled, and no figure changes. A row that a logger wrote again before there was anything new is no second witness
//! of how large the noise is. A row again at the same moment is a mistake and refused.

use super::chain::{Change, alike, answer, answer_with, campaigns, settings, within};
use std::fs;
use tempfile::TempDir;
use trainer::campaign::{Campaign, CampaignError, HoldOut, ReadOptions, Row};
use trainer::compare::compare;
use trainer::progress::Quiet;
use trainer::train::train;

const AGAIN: &str = " again";

/// Every run a second time, under another name.
fn twice(campaign: &Campaign) -> Campaign {
    let mut runs = campaign.runs.clone();
    runs.extend(campaign.runs.iter().cloned().map(|mut run| {
        run.name += AGAIN;
        run
    }));
    Campaign::new(runs, campaign.channels.clone(), campaign.quantity.clone())
}

#[test]
fn the_same_runs_under_two_names_are_the_same_findings_with_twice_the_evidence() {
    for (what, campaign) in campaigns() {
        let held_out = campaign.split(&HoldOut::LastOfEachKind).expect("a split").held_out;
        let names = held_out.iter().map(|&index| campaign.runs[index].name.clone());
        let both = names.flat_map(|name| [name.clone(), name + AGAIN]).collect();
        let (one, other) =
            (answer(&campaign), answer_with(&twice(&campaign), &HoldOut::Named(both), &settings(Vec::new())));
        alike(what, &one, &other, &Change { factor: 1.0, evidence: 2.0, near: 0.05, evidence_near: 0.15 }, |_| 0);
    }
}

#[test]
fn a_logger_faster_than_the_sensor_is_no_witness_of_less_noise() {
    for (what, campaign) in campaigns() {
        let mut faster = campaign.clone();
        for run in &mut faster.runs {
            let again = |row: &Row| {
                let mut later = *row;
                later.sample.time_us += 500_000;
                later.sample.power_on_us += 500_000;
                [*row, later]
            };
            run.rows = run.rows.iter().flat_map(again).collect();
        }
        let faster = Campaign::new(faster.runs, faster.channels, faster.quantity);
        let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
        let model = train(&campaign, &split, &settings(Vec::new()), &Quiet).expect("a model").model;
        let noise_ug = |campaign| compare(&model, campaign).expect("a comparison").noise_floor_ug.expect("neighbours");
        within(0.05, what, noise_ug(&campaign), noise_ug(&faster));
    }
}

#[test]
fn a_row_again_at_the_same_moment_is_refused_with_its_place() {
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    let rows = "full,0,20,76,0\nfull,0,20,76,0\nfull,1,21,77,0\nfull,1,21,77,0\n";
    fs::write(&file, format!("run,time_s,temperature_c,delta_f_hz,reference_g\n{rows}")).expect("written");
    let refused = Campaign::read(&[file], &ReadOptions::default()).expect_err("no row has its time twice");
    assert!(matches!(refused, CampaignError::TimeNotIncreasing(_)), "{refused}");
    assert!(refused.to_string().contains("campaign.csv:3, column 2 (time_s): found 0 s again"), "{refused}");
}
