//! Figures say what they claim to say: on which rows they were computed, in whose arithmetic, and since when time counts.

use firmware_core::Compensator;
use protocol::Status;
use tempfile::TempDir;
use trainer::campaign::{Campaign, HoldOut, ReadOptions, Run};
use trainer::compare::{Comparison, compare};
use trainer::model::Model;
use trainer::progress::Quiet;
use trainer::report::report;
use trainer::train::{EffectChoice, TrainSettings, train};

const SMALL: &str = include_str!("campaigns/small.csv");
const HELD_OUT: &str = "full-3";

fn read(text: &str) -> Campaign {
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    std::fs::write(&file, text).expect("written");
    Campaign::read(&[file], &ReadOptions::default()).expect("a campaign")
}

/// The small campaign with every row changed.
fn changed(change: impl Fn(&mut [String])) -> Campaign {
    let (header, rows) = SMALL.split_once('\n').expect("a header");
    let mut text = header.to_owned() + "\n";
    for row in rows.lines() {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        change(&mut cells);
        text += &(cells.join(",") + "\n");
    }
    read(&text)
}

/// One run's reference is 100 µg too high, and that run is held out: no other row knows of it.
fn one_run_apart() -> (Campaign, Model) {
    let campaign = changed(|cells| {
        if cells[0] == HELD_OUT {
            let reference_g: f64 = cells[5].parse().expect("a number");
            cells[5] = (reference_g + 100e-6).to_string();
        }
    });
    let split = campaign.split(&HoldOut::Named(vec![HELD_OUT.to_owned()])).expect("a split");
    let settings = TrainSettings { restarts: 2, ..TrainSettings::new(1) };
    let model = train(&campaign, &split, &settings, &Quiet).expect("a model").model;
    (campaign, model)
}

/// Reading less reference of each row, µg, and how many readings were flagged, as a device that runs the blob gives them.
fn by_hand(model: &Model, run: &Run) -> (Vec<f64>, usize) {
    let mut device = Compensator::load(&model.to_blob().expect("a blob")).expect("it loads");
    let mut flagged = 0;
    let of_row = |row: &trainer::campaign::Row| {
        let reading = device.compensate(&row.sample);
        flagged += usize::from(reading.status != Status::empty());
        (f64::from(reading.acceleration_g) - row.reference_g) * 1e6
    };
    let residuals_ug = run.rows.iter().map(of_row).collect();
    (residuals_ug, flagged)
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-6
}

#[test]
fn the_headline_residual_is_that_of_the_held_out_run_and_each_run_has_its_own() {
    let (campaign, model) = one_run_apart();
    let comparison = compare(&model, &campaign).expect("a comparison");
    assert!(comparison.held_out && comparison.runs.len() == campaign.runs.len());
    for (found, run) in comparison.runs.iter().zip(&campaign.runs) {
        let (residuals_ug, flagged) = by_hand(&model, run);
        let mean_ug = residuals_ug.iter().sum::<f64>() / residuals_ug.len() as f64;
        let about_mean: Vec<f64> = residuals_ug.iter().map(|residual| residual - mean_ug).collect();
        assert_eq!((found.run.as_str(), found.kind.as_str()), (run.name.as_str(), run.kind.as_str()));
        assert_eq!((found.samples, found.flagged), (run.rows.len(), flagged), "{}", run.name);
        assert_eq!(found.held_out, run.name == HELD_OUT);
        assert!(near(found.residual_ug, rms(&residuals_ug)), "{}", run.name);
        assert!(near(found.mean_ug, mean_ug) && near(found.about_mean_ug, rms(&about_mean)), "{}", run.name);
        if found.held_out {
            assert!(near(comparison.residual_ug, rms(&residuals_ug)));
            assert!(comparison.residual_ug > 80.0, "a run that is 100 µg off: {} µg", comparison.residual_ug);
        } else {
            assert!(found.residual_ug < 20.0, "{} has no such offset: {} µg", run.name, found.residual_ug);
        }
    }
    // An offset of a run is no noise from sample to sample; the campaign's own is near 5 µg.
    assert!(comparison.noise_floor_ug.is_some_and(|floor_ug| (4.0..6.5).contains(&floor_ug)));
}

#[test]
fn runs_of_another_campaign_were_all_unseen_whatever_they_are_called() {
    let (campaign, model) = one_run_apart();
    let other = changed(|_| {});
    let comparison = compare(&model, &other).expect("a comparison");
    assert!(comparison.held_out && comparison.runs.iter().all(|run| run.held_out));
    let all: Vec<f64> = other.runs.iter().flat_map(|run| by_hand(&model, run).0).collect();
    assert!(near(comparison.residual_ug, rms(&all)));
    // And where nothing was held out, every row counts and nobody calls it held out.
    let mut seen = model;
    seen.provenance.training_runs = campaign.runs.iter().map(|run| run.name.clone()).collect();
    let comparison = compare(&seen, &campaign).expect("a comparison");
    let all: Vec<f64> = campaign.runs.iter().flat_map(|run| by_hand(&seen, run).0).collect();
    assert!(!comparison.held_out && near(comparison.residual_ug, rms(&all)));
}

#[test]
fn the_report_prints_the_figures_of_the_comparison() {
    let (campaign, model) = one_run_apart();
    let report = report(&model, &campaign).expect("a report");
    let comparison = compare(&model, &campaign).expect("a comparison");
    assert!(near(report.verdict.residual_ug, comparison.residual_ug));
    assert!(near(report.merits[0].compensated, comparison.residual_ug) && report.merits[0].held_out);
    let of_run = comparison.figures.iter().find(|figures| figures.run == HELD_OUT).expect("six nodes");
    let expected = of_run.compensated.full_temperature.as_ref().expect("six nodes").scale_factor_variation_ppm;
    let merit = report.merits.iter().find(|merit| merit.name == "Variation of scale factor").expect("in the table");
    assert!(merit.run.as_deref() == Some(HELD_OUT) && near(merit.compensated, expected));
}

#[test]
fn every_position_of_the_tumbles_counts_in_k1_and_b0() {
    let (campaign, model) = one_run_apart();
    let comparison = compare(&model, &campaign).expect("a comparison");
    for name in ["full-1", "tumble-1", "tumble-2"] {
        let figures = comparison.figures.iter().find(|figures| figures.run == name).expect("several nodes");
        let compensated = figures.compensated.full_temperature.as_ref().expect("several nodes");
        // The readings are right to a few µg, and so is what a line through them says.
        assert!(compensated.scale_factor_variation_ppm < 10.0, "{name}: {compensated:?}");
        assert!(compensated.bias_variation_ug < 10.0, "{name}: {compensated:?}");
        for node in &compensated.nodes {
            assert!(node.positions >= 8 && (node.scale_factor_per_g - 1.0).abs() < 20e-6, "{name}: {node:?}");
            assert!(node.scale_factor_sigma_per_g.is_some_and(|sigma| sigma < 10e-6), "{name}: {node:?}");
        }
    }
}

/// The small campaign whose runs begin at this time, with the model that it teaches and its comparison.
fn begun_at(epoch_s: f64) -> (Campaign, Model, Comparison) {
    let original = changed(|_| {});
    let first_s = |name: &str| {
        let run = original.runs.iter().find(|run| run.name == name).expect("a run");
        run.rows[0].sample.time_us as f64 * 1e-6
    };
    let campaign = changed(|cells| {
        let time_s: f64 = cells[2].parse().expect("a number");
        cells[2] = format!("{:.3}", time_s - first_s(&cells[0]) + epoch_s);
    });
    let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let effects = vec![EffectChoice::named("warm-up")];
    let settings = TrainSettings { restarts: 2, effects, ..TrainSettings::new(1) };
    let model = train(&campaign, &split, &settings, &Quiet).expect("a model").model;
    let comparison = compare(&model, &campaign).expect("a comparison");
    (campaign, model, comparison)
}

#[test]
fn a_calendars_clock_gives_the_same_model_and_the_same_figures() {
    let (_, plain, expected) = begun_at(0.0);
    for epoch_s in [1.7e9, 3.8e9] {
        let (campaign, model, comparison) = begun_at(epoch_s);
        assert!(campaign.runs.iter().all(Run::has_calendar_time));
        assert_eq!((&model.network, &model.effects), (&plain.network, &plain.effects));
        let json = |comparison: &Comparison| serde_json::to_string(comparison).expect("JSON");
        assert_eq!(json(&comparison), json(&expected));
    }
}

#[test]
fn another_unit_scales_the_figures_and_nothing_else() {
    let with_unit = |unit: f64| -> Vec<(String, f64, f64)> {
        let mut campaign = changed(|_| {});
        campaign.runs.iter_mut().flat_map(|run| &mut run.rows).for_each(|row| row.reference_g *= unit);
        let figures = |run: &Run| {
            let outputs: Vec<f64> = run.rows.iter().map(|row| row.sample.delta_f_uhz as f64 * 1e-6).collect();
            let found = trainer::metrics::full_temperature::full_temperature(run, &outputs)?;
            Some((run.name.clone(), found.scale_factor_variation_ppm, found.bias_variation_ug / unit))
        };
        campaign.runs.iter().filter_map(figures).collect()
    };
    let expected = with_unit(1.0);
    assert_eq!(expected.len(), 5, "three runs over nodes and two tumbles");
    for unit in [1e3, 1e-6] {
        for (found, expected) in with_unit(unit).iter().zip(&expected) {
            assert_eq!(found.0, expected.0);
            assert!((found.1 / expected.1 - 1.0).abs() < 1e-6 && (found.2 / expected.2 - 1.0).abs() < 1e-6, "{unit}");
        }
    }
}
