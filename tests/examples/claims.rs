//! Prints the figures that the documents claim of training. Takes the number of seeds, 100 by default:
//!
//! ```text
//! cargo run --release -p tests --example claims -- 100
//! ```

use firmware_sim::scenario::Scenario;
use firmware_sim::simulation;
use firmware_sim::twin::static_map::StaticMap;
use protocol::Sample;
use std::ops::ControlFlow;
use tempfile::TempDir;
use trainer::campaign::{Campaign, HoldOut, ReadOptions, Row, Run, Split};
use trainer::compare::{Comparison, compare};
use trainer::model::Model;
use trainer::noise::rms;
use trainer::progress::Quiet;
use trainer::residuals::residuals;
use trainer::sensitivity::over_domain;
use trainer::train::{Anchoring, EffectChoice, TrainSettings, train};

fn main() {
    let seeds = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(100);
    near_the_floor(seeds);
    anchors(seeds.min(20));
    paper_cells(seeds.min(20));
}

struct Measured {
    campaign: Campaign,
    floor_ug: f64,
    truth: StaticMap,
}

fn measure(preset: &str, seed: u64) -> Measured {
    let scenario = Scenario::preset(preset).expect("a built-in scenario");
    let recording = simulation::simulate(&scenario, seed, &mut |_| ControlFlow::Continue(())).expect("a recording");
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    recording.write_csv(&mut std::fs::File::create(&file).expect("a file")).expect("written");
    Measured {
        campaign: Campaign::read(&[file], &ReadOptions::default()).expect("a campaign"),
        floor_ug: recording.noise_floor_ug(),
        truth: StaticMap::new(&scenario.device),
    }
}

/// Share of clean campaigns on which the held-out residual is within 2 % of the stated noise floor.
fn near_the_floor(seeds: u64) {
    let ratio = |seed| {
        let measured = measure("clean", seed);
        let split = measured.campaign.split(&HoldOut::LastOfEachKind).expect("a split");
        let settings = TrainSettings { restarts: 8, ..TrainSettings::new(seed) };
        let model = train(&measured.campaign, &split, &settings, &Quiet).expect("a model").model;
        compare(&model, &measured.campaign).expect("a comparison").residual_ug / measured.floor_ug
    };
    let ratios: Vec<f64> = (1..=seeds).map(ratio).collect();
    let within = ratios.iter().filter(|ratio| **ratio <= 1.02).count();
    let worst = ratios.iter().fold(0.0_f64, |worst, ratio| worst.max(*ratio));
    println!(
        "clean campaigns: held-out residual within 2 % of the stated noise floor in {within} of {seeds}; worst {worst:.4}"
    );
}

/// What the anchors do for a campaign of three levels and six nodes, with and without them.
fn anchors(seeds: u64) {
    println!(
        "\nscenario `seed`, {seeds} seeds: medians          held-out µg   off level and node µg   worst slope error ppm"
    );
    let choices = [
        ("nothing", Anchoring::Nothing),
        ("slopes", Anchoring::Slopes),
        ("values", Anchoring::Values),
        ("slopes and values", Anchoring::Both),
    ];
    for (name, anchoring) in choices {
        let each = |seed| {
            let measured = measure("seed", seed);
            let (model, comparison) = seed_model(&measured.campaign, seed, anchoring, Vec::new());
            let slope = over_domain(&model, |f, t| measured.truth.slope_g_per_hz(f * 1e-6, t * 1e-6));
            [comparison.residual_ug, between_levels_ug(&model, &measured.truth), slope.worst]
        };
        let rows: Vec<[f64; 3]> = (1..=seeds).map(each).collect();
        let [held_out, between, slope] = [0, 1, 2].map(|column| median(rows.iter().map(|row| row[column]).collect()));
        println!("  anchored to {name:20}               {held_out:10.1}   {between:21.1}   {slope:21.0}");
    }
}

/// The paper's tables on the paper's campaign, with the warm-up that it hides added to the model.
fn paper_cells(seeds: u64) {
    println!("\nscenario `seed` with warm-up added, {seeds} seeds: medians (paper's IFA-BP, dataset 1 and 2)");
    let mut cells: [Vec<f64>; 7] = Default::default();
    for seed in 1..=seeds {
        let measured = measure("seed", seed);
        let effects = vec![EffectChoice::named("warm-up")];
        let (model, comparison) = seed_model(&measured.campaign, seed, Anchoring::Both, effects);
        cells[6].push(between_levels_ug(&model, &measured.truth));
        for run in comparison.figures.iter().filter(|run| run.held_out) {
            if let Some(figures) = &run.compensated.full_temperature {
                cells[0].push(figures.scale_factor_variation_ppm);
                cells[1].push(figures.bias_variation_ug);
            }
            if let Some(figures) = run.compensated.zero_bias {
                cells[2].push(figures.from_start_ug);
                cells[3].push(figures.after_20_min_ug);
                cells[4].push(figures.after_30_min_ug);
            }
        }
        let slope = over_domain(&model, |f, t| measured.truth.slope_g_per_hz(f * 1e-6, t * 1e-6));
        cells[5].push(slope.worst);
    }
    let names = [
        "variation of scale factor ppm (214.86, 30.806)",
        "variation of bias µg (32.967, 36.556)",
        "zero-bias from start µg (11.868, 12.750)",
        "zero-bias after 20 min µg (9.6671, 10.127)",
        "zero-bias after 30 min µg (7.7562, 7.4809)",
        "worst slope error ppm",
        "worst residual at ±0.5 g, on and off the nodes, µg",
    ];
    for (name, values) in names.iter().zip(cells) {
        let worst = values.iter().fold(0.0_f64, |worst, value| worst.max(*value));
        println!("  {name:52} median {:8.2}   worst {worst:8.2}", median(values));
    }
}

fn seed_model(campaign: &Campaign, seed: u64, anchoring: Anchoring, effects: Vec<EffectChoice>) -> (Model, Comparison) {
    let held_out = ["zero-test-1", "zero-test-2", "full-test-1", "full-test-2"].map(str::to_owned);
    let split: Split = campaign.split(&HoldOut::Named(held_out.to_vec())).expect("a split");
    let settings = TrainSettings { restarts: 8, anchoring, effects, ..TrainSettings::new(seed) };
    let model = train(campaign, &split, &settings, &Quiet).expect("a model").model;
    let comparison = compare(&model, campaign).expect("a comparison");
    (model, comparison)
}

/// RMS about the mean at ±0.5 g from −40 to 60 °C in steps of 5 °C, against the true inverse, µg. The mean
/// is left out: no model can know the turn-on offset of the runs that it learnt from.
fn between_levels_ug(model: &Model, truth: &StaticMap) -> f64 {
    let row = |level_g: f64, temperature_c: f64| {
        let delta_f_uhz = (truth.delta_f_hz(level_g, temperature_c) * 1e6).round() as i64;
        // Long after power-on: what a warm-up leaves then is nothing.
        let sample = Sample::from_difference(1_000_000_000_000, delta_f_uhz, (temperature_c * 1e6) as i32);
        Row { sample, reference_g: level_g, reference_sigma_g: None }
    };
    let one = |row: Row| {
        let run = Run { name: "probe".to_owned(), kind: String::new(), source: "probe".into(), rows: vec![row] };
        residuals(model, [&run]).expect("a residual").runs[0].residuals_g[0]
    };
    let places = [-0.5, 0.5].into_iter().flat_map(|level_g| (-8..=12).map(move |k| (level_g, f64::from(k) * 5.0)));
    let all: Vec<f64> = places.map(|(level_g, temperature_c)| one(row(level_g, temperature_c))).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    rms(&all.iter().map(|value| value - mean).collect::<Vec<_>>()) * 1e6
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
