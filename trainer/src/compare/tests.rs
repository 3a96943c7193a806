//! Of a model that is a line, whose every residual is known.

use super::*;
use crate::campaign::{Quantity, Row};
use crate::model::example;
use protocol::{Sample, Status};
use std::path::PathBuf;

/// Reads 0 g at 76 Hz and 12.5 mg/Hz, at any temperature.
fn line() -> Model {
    let mut model = example::model();
    model.scaling.line_g = [0.0, 1.0, 0.0, 0.0];
    model.scaling.output_g = 0.0;
    model.effects.clear();
    model.provenance.scale_factor_hz_per_g = None;
    model
}

/// One row a step of so many seconds: what is applied, how far the line's reading is off, µg, and the temperature, °C.
fn run(name: &str, kind: &str, step_s: u64, rows: impl IntoIterator<Item = (f64, f64, f64)>) -> Run {
    let row = |(index, (reference_g, off_ug, c)): (u64, (f64, f64, f64))| {
        let delta_f_uhz = 76_000_000 + ((reference_g + off_ug * 1e-6) * 80e6).round() as i64;
        let sample = Sample::from_difference(index * step_s * 1_000_000, delta_f_uhz, (c * 1e6) as i32);
        Row { sample, reference_g, reference_sigma_g: None }
    };
    let rows = (0..).zip(rows).map(row).collect();
    Run { name: name.to_owned(), kind: kind.to_owned(), source: PathBuf::new(), rows }
}

fn alternating(size_ug: f64, count: u32) -> impl Iterator<Item = (f64, f64, f64)> {
    (0..count).map(move |k| (0.0, if k % 2 == 0 { size_ug } else { -size_ug }, 25.0))
}

fn campaign(runs: Vec<Run>) -> Campaign {
    Campaign::new(runs, Vec::new(), Quantity::default())
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 2e-3 * expected.abs().max(1.0)
}

#[test]
fn the_headline_is_of_the_runs_that_were_not_seen_and_each_run_has_its_own() {
    let seen = run("seen", "ramp", 1, (0..40).map(|_| (0.001, 10.0, 25.0)));
    let unseen = run("unseen", "ramp", 1, (0..40).map(|k| (0.001, if k % 2 == 0 { 50.0 } else { -10.0 }, 25.0)));
    let campaign = campaign(vec![seen, unseen]);
    let mut model = line();
    model.provenance.training_runs = vec!["seen".to_owned()];
    model.provenance.campaign = campaign.hash();
    let comparison = compare(&model, &campaign).expect("a comparison");
    assert!(comparison.held_out && near(comparison.residual_ug, 1300.0_f64.sqrt()), "{comparison:?}");
    assert_eq!(comparison.runs.iter().map(|run| run.held_out).collect::<Vec<_>>(), [false, true]);
    let figures = |run: &RunComparison| [run.residual_ug, run.mean_ug, run.about_mean_ug];
    assert!(figures(&comparison.runs[0]).into_iter().zip([10.0, 10.0, 0.0]).all(|(a, b)| (a - b).abs() < 0.05));
    assert!(figures(&comparison.runs[1]).into_iter().zip([1300.0_f64.sqrt(), 20.0, 30.0]).all(|(a, b)| near(a, b)));
    // Under the same names, in another campaign, nothing was seen.
    model.provenance.campaign = "00".to_owned();
    let other = compare(&model, &campaign).expect("a comparison");
    assert!(other.held_out && other.runs.iter().all(|run| run.held_out));
    assert!(near(other.residual_ug, 700.0_f64.sqrt()), "{other:?}");
    // And where all was seen, all counts and nothing is called held out.
    model.provenance.training_runs.push("unseen".to_owned());
    model.provenance.campaign = campaign.hash();
    let all = compare(&model, &campaign).expect("a comparison");
    assert!(!all.held_out && near(all.residual_ug, 700.0_f64.sqrt()));
}

#[test]
fn the_noise_floor_is_that_of_neighbouring_samples() {
    // Each is 10 µg from the straight line through its neighbours, which has 3/2 of a sample's variance.
    let campaign = campaign(vec![run("noise", "static", 1, alternating(5.0, 100))]);
    let comparison = compare(&line(), &campaign).expect("a comparison");
    assert!(near(comparison.noise_floor_ug.expect("one state"), 10.0 / 0.674_49 / 1.5_f64.sqrt()));
}

#[test]
fn what_is_flagged_is_counted_and_what_has_no_number_is_refused_in_its_row() {
    // The domain ends at 1 g and at 85 °C.
    let rows = [(0.5, 0.0, 25.0), (1.2, 0.0, 25.0), (0.5, 0.0, 86.0), (0.9, 0.0, 84.0), (0.0, 0.0, 0.0)];
    let mut campaign = campaign(vec![run("hot", "ramp", 1, rows)]);
    let comparison = compare(&line(), &campaign).expect("a comparison");
    assert_eq!((comparison.runs[0].flagged, comparison.runs[0].samples), (2, 5));
    campaign.runs[0].rows[2].sample.faults = Status::THERMOMETER_FAULT;
    let refused = compare(&line(), &campaign).expect_err("no number");
    assert!(matches!(&refused, ResidualError::NoNumber { run, row: 3, .. } if run == "hot"), "{refused}");
}

#[test]
fn raw_figures_are_of_the_frequency_over_the_mean_scale_factor() {
    assert!((mean_slope_g_per_hz(&line()) - 0.0125).abs() < 1e-9);
    // The reference drifts by 20 µg a row and the sensor follows: neither residual drifts.
    let drifting = (0..300).map(|k| (f64::from(k) * 20e-6, if k % 2 == 0 { 5.0 } else { -5.0 }, 25.0));
    let campaign = campaign(vec![run("still", "static", 10, drifting), run("zero", "zero", 10, alternating(5.0, 300))]);
    let comparison = compare(&line(), &campaign).expect("a comparison");
    let [still, zero] = comparison.figures.as_slice() else { panic!("two runs at rest") };
    for figures in [&still.raw, &still.compensated, &zero.raw, &zero.compensated] {
        let allan = figures.allan.as_ref().expect("300 even rows");
        assert!(near(allan[0].deviation_ug, 50.0_f64.sqrt()) && allan[1].deviation_ug < 0.2, "{allan:?}");
        assert!(figures.stability.is_some() && figures.full_temperature.is_none());
    }
    assert!(still.raw.zero_bias.is_none() && still.compensated.zero_bias.is_none());
    for figures in [&zero.raw, &zero.compensated] {
        let zero_bias = figures.zero_bias.expect("fifty minutes");
        assert!(near(zero_bias.from_start_ug, 5.0 * (300.0_f64 / 299.0).sqrt()), "{zero_bias:?}");
    }
    assert_eq!((still.run.as_str(), zero.run.as_str()), ("still", "zero"));
}

#[test]
fn a_run_has_the_figures_that_it_allows_and_none_has_no_entry() {
    let nodes = [-40.0, 25.0, 85.0].into_iter().flat_map(|c| [1.0, -1.0].map(|g| (g, c)));
    let full = run("full", "full", 1, nodes.flat_map(|(g, c)| [(0.9 * g, 0.0, c); 12]));
    // Too short for one figure, too uneven for the other.
    let short = run("short", "zero", 1, alternating(5.0, 100));
    let mut uneven = run("uneven", "zero", 10, alternating(5.0, 300));
    uneven.rows.remove(150);
    let ramp = run("ramp", "ramp", 1, (0..100).map(|k| (f64::from(k) * 0.01, 0.0, f64::from(k))));
    let comparison = compare(&line(), &campaign(vec![full, short, uneven, ramp])).expect("a comparison");
    let found = |figures: &RunFigures| {
        let of = &figures.compensated;
        (figures.run.clone(), of.full_temperature.is_some(), of.allan.is_some(), of.zero_bias.is_some())
    };
    let expected = [("full", true, false, false), ("short", false, true, false), ("uneven", false, false, true)];
    let expected = expected.map(|(run, full, allan, zero)| (run.to_owned(), full, allan, zero));
    assert_eq!(comparison.figures.iter().map(found).collect::<Vec<_>>(), expected);
    let of_full = &comparison.figures[0];
    let [raw, compensated] =
        [&of_full.raw, &of_full.compensated].map(|of| of.full_temperature.as_ref().expect("nodes"));
    assert!(near(raw.nodes[0].scale_factor_per_g, 80.0) && near(compensated.nodes[0].scale_factor_per_g, 1.0));
}

#[test]
fn channels_are_put_into_the_models_order_and_left_alone_where_it_has_none() {
    let mut campaign = campaign(vec![run("run", "ramp", 1, alternating(5.0, 4))]);
    campaign.channels = vec!["a_v".to_owned(), "b_v".to_owned()];
    assert_eq!(arranged(&line(), &campaign).expect("as it is").channels, ["a_v", "b_v"]);
    let mut model = line();
    model.channels = vec!["b_v".to_owned(), "a_v".to_owned()];
    assert_eq!(arranged(&model, &campaign).expect("both are there").channels, ["b_v", "a_v"]);
}
