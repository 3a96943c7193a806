//! A long noisy record of a sensor at rest, whose reading is in parts per million: how many µg a ppm stands for is a unit
//! and changes no verdict.

use super::chain::{Answer, Change, alike, answer_with, settings};
use protocol::Sample;
use std::f64::consts::TAU;
use std::path::PathBuf;
use trainer::campaign::{Campaign, HoldOut, Quantity, Row, Run};
use trainer::train::TrainSettings;

/// Pseudorandom numbers, the same in every run.
struct Random(u64);

impl Random {
    /// Near enough to normal.
    fn normal(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        (0..12).map(|_| uniform()).sum()
    }
}

/// What else is in the record, ppm.
#[derive(Clone, Copy)]
struct Drift {
    /// Of a relaxation over hours after power-on.
    relaxes: f64,
    /// Of the random walk, per √min.
    walks: f64,
    /// Of the thermometer's delay behind the crystal, min.
    lags: f64,
}

/// Four days, a run each, a row a minute: a room that the sun and the heating warm.
fn record(drift: Drift) -> Campaign {
    let mut random = Random(7);
    let day = |number: u32| {
        let (mut walk, mut inside_c) = (0.0, 24.0);
        let row = |minute: u32| {
            let hours = f64::from(minute) / 60.0;
            let swing = |period_h: f64| (TAU * (hours / period_h + f64::from(number) * 0.31)).sin();
            let outside_c = 24.0 + 3.0 * swing(24.0) + 0.8 * swing(1.7) + 2.0 * swing(5.3);
            inside_c += (outside_c - inside_c) / (1.0 + drift.lags);
            walk += drift.walks * random.normal();
            let warm_c: f64 = inside_c - 25.0;
            let relaxed = drift.relaxes * (-hours / 3.0).exp();
            let read = 0.9 * warm_c - 0.035 * warm_c * warm_c + relaxed + walk + 0.25 * random.normal();
            let temperature_uc = ((outside_c + 0.002 * random.normal()) * 1e6) as i32;
            let sample = Sample::from_difference(u64::from(minute) * 60_000_000, (read * 1e6) as i64, temperature_uc);
            Row { sample, reference_g: 0.0, reference_sigma_g: None }
        };
        let rows = (0..1200).map(row).collect();
        Run { name: format!("day-{number}"), kind: "static".to_owned(), source: PathBuf::new(), rows }
    };
    let quantity = Quantity { signal_unit: "ppm".to_owned(), ..Quantity::default() };
    Campaign::new((1..=4).map(day).collect(), Vec::new(), quantity)
}

/// The answer where a ppm stands for so many µg.
fn answer(campaign: &Campaign, ug_per_ppm: f64) -> Answer {
    let settings = TrainSettings { scale_factor_hz_per_g: Some(1e6 / ug_per_ppm), ..settings(Vec::new()) };
    answer_with(campaign, &HoldOut::LastOfEachKind, &settings)
}

#[test]
fn how_many_micro_g_a_ppm_stands_for_changes_no_verdict() {
    for (what, drift) in [
        ("a walk", Drift { relaxes: 0.0, walks: 0.05, lags: 0.0 }),
        ("a walk and a relaxation", Drift { relaxes: 2.0, walks: 0.05, lags: 0.0 }),
        ("a lag in noise", Drift { relaxes: 0.0, walks: 0.01, lags: 6.0 }),
    ] {
        let campaign = record(drift);
        let one = answer(&campaign, 1.0);
        for ug_per_ppm in [10.0, 1e3] {
            let change = Change { factor: ug_per_ppm, evidence: 1.0, near: 0.03, evidence_near: 0.03 };
            let power = |name: &str| i32::from(name.contains("_g"));
            alike(&format!("{what}, 1 ppm = {ug_per_ppm} µg"), &one, &answer(&campaign, ug_per_ppm), &change, power);
        }
    }
}
