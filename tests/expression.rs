//! Claim: an effect that nobody foresaw, written down by a user, is fitted, carried to the device and taken out there.

use firmware_core::program::Program;
use firmware_core::{Compensator, LoadError};
use firmware_sim::scenario::Scenario;
use firmware_sim::simulation;
use firmware_sim::virtual_instrument::VirtualInstrument;
use protocol::limits::MAX_PROGRAM;
use protocol::{Blob, Request, Sample, Status, Term};
use std::ops::ControlFlow;
use std::sync::LazyLock;
use tempfile::TempDir;
use tests::example;
use trainer::campaign::{Campaign, HoldOut, ReadOptions, Run};
use trainer::compare::compare;
use trainer::effect_choice::EffectError;
use trainer::model::Model;
use trainer::progress::Quiet;
use trainer::replay::replay;
use trainer::train::{EffectChoice, TrainError, TrainSettings, check, train};

/// What no effect of the catalogue does: bias in proportion to supply times rate.
const EXPRESSION: &str = "supply_v * temperature_rate";
/// What is hidden: g per V·°C/s, and the time over which the rate is felt, s.
const HIDDEN: (f64, f64) = (3e-3, 90.0);

const LONGEST_GAP_S: f64 = 60.0;

const SCENARIO: &str = r#"
name = "own"
description = "Soaked nodes, and ramps up and down."

[noise]
flicker_ug = 0.3
random_walk_ug_per_sqrt_s = 0.002

[[run]]
name = "full"
kind = "full"
repeat = 3
positions_deg = [0, 30, 90, 150, 180, 210, 270, 330]
settle_s = 5
dwell_s = 10

[[run]]
name = "ramp"
kind = "ramp"
repeat = 3
rates_k_per_min = [3, 1]
hold_s = 900
record_every_s = 10
"#;

struct Recorded {
    campaign: Campaign,
    floor_ug: f64,
}

/// A simulated campaign with an effect put in by hand, so that it shares no formula with what is tested.
static RECORDED: LazyLock<Recorded> = LazyLock::new(|| {
    let scenario = Scenario::from_toml(SCENARIO).expect("a scenario");
    let recording = simulation::simulate(&scenario, 5, &mut |_| ControlFlow::Continue(())).expect("a recording");
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    recording.write_csv(&mut std::fs::File::create(&file).expect("a file")).expect("written");
    let plain = Campaign::read(&[file], &ReadOptions::default()).expect("a campaign");
    let runs = plain.runs.into_iter().enumerate().map(|(index, run)| hide(run, index)).collect();
    let campaign = Campaign::new(runs, vec!["pressure_pa".to_owned(), "supply_v".to_owned()], plain.quantity);
    Recorded { campaign, floor_ug: recording.noise_floor_ug() }
});

/// Gives a run a supply that steps up and down, and the bias that comes of it.
fn hide(mut run: Run, index: usize) -> Run {
    let (amplitude_g, tau_s) = HIDDEN;
    let (mut last_s, mut last_c, mut felt_c) = (f64::MIN, 0.0, 0.0);
    for (count, row) in run.rows.iter_mut().enumerate() {
        let (time_s, now_c) = (row.sample.time_us as f64 * 1e-6, f64::from(row.sample.temperature_uc) * 1e-6);
        let gap_s = time_s - last_s;
        // A resistor and a capacitor: what they lag behind is τ times the rate. Soaked for an hour they lag no more.
        let forgotten = (-gap_s / tau_s).exp();
        let driven_c = (now_c - last_c) * tau_s / gap_s * (1.0 - forgotten);
        felt_c = if gap_s < LONGEST_GAP_S { felt_c * forgotten + driven_c } else { 0.0 };
        (last_s, last_c) = (time_s, now_c);
        let supply_v = [4.5, 5.0, 5.5][(count / 60 + index) % 3];
        row.sample.channels[1] = (supply_v * 1e6) as i64;
        // The same reading at an acceleration that is less by the bias.
        row.reference_g -= amplitude_g * supply_v * felt_c / tau_s;
    }
    run
}

fn model(effects: Vec<EffectChoice>) -> Model {
    let split = RECORDED.campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let settings = TrainSettings { restarts: 3, effects, ..TrainSettings::new(1) };
    train(&RECORDED.campaign, &split, &settings, &Quiet).expect("a model").model
}

fn residual_ug(model: &Model) -> f64 {
    compare(model, &RECORDED.campaign).expect("a comparison").residual_ug
}

/// The expression's model, trained once for all tests.
static MODEL: LazyLock<Model> = LazyLock::new(|| model(vec![EffectChoice::expression(EXPRESSION)]));

#[test]
fn what_is_hidden_is_found_and_the_residual_falls_to_the_noise() {
    let alone = residual_ug(&model(Vec::new()));
    let catalogue = residual_ug(&model(vec![EffectChoice::expression("temperature_rate")]));
    let with = residual_ug(&MODEL);
    println!("alone {alone:.2} µg, rate {catalogue:.2} µg, with {with:.2} µg, floor {:.2} µg", RECORDED.floor_ug);
    println!("{:?}", MODEL.effects);
    assert!(with < 1.1 * RECORDED.floor_ug && alone > 5.0 * with && catalogue > 1.5 * with);
    let effect = &MODEL.effects[0];
    assert_eq!(
        (effect.expression.as_deref(), MODEL.channels.as_slice()),
        (Some(EXPRESSION), &["supply_v".to_owned()][..])
    );
    let off = |name: &str, hidden: f64| (effect.parameters[name] / hidden - 1.0).abs();
    assert!(off("amplitude_g", HIDDEN.0) < 0.03 && off("tau_s", HIDDEN.1) < 0.1, "{effect:?}");
}

#[test]
fn the_instrument_gives_the_hosts_bits_through_the_stored_calibration() {
    let blob = Blob::from_bytes(&MODEL.to_bytes().expect("it fits")).expect("sound bytes");
    let campaign = RECORDED.campaign.arranged(&["supply_v"]).expect("it has the channel");
    let mut instrument = VirtualInstrument::new("");
    instrument.upload(&blob).expect("uploaded");
    for run in &campaign.runs {
        let samples: Vec<_> = run.rows.iter().map(|row| row.sample).collect();
        instrument.exchange(Request::Restart).expect("restarted");
        let there = instrument.replay(&samples).expect("readings");
        let here = replay(&blob, run).expect("readings");
        assert!(there.iter().zip(&here).all(|(there, here)| there.same_bits(here)), "run {}", run.name);
    }
}

#[test]
fn a_model_file_with_it_is_read_as_it_was_written_and_trained_on_from_where_it_is() {
    let text = MODEL.to_text();
    assert!(text.contains("expression = \"supply_v * temperature_rate\""), "{text}");
    assert_eq!(toml::from_str::<Model>(&text).expect("a model"), *MODEL);
    let choice = &EffectChoice::of(&MODEL)[0];
    assert_eq!((choice.title(), choice.start.as_ref().map(Vec::len)), (EXPRESSION, Some(2)));
    assert!(choice.is_same(&EffectChoice::expression("supply_v*temperature_rate")));
}

#[test]
fn several_expressions_share_a_model_and_a_time_constant_is_fitted_only_where_there_is_a_past() {
    let two = model(vec![EffectChoice::expression(EXPRESSION), EffectChoice::expression("(supply_v - 5) * level_g")]);
    assert!(residual_ug(&two) < 1.1 * RECORDED.floor_ug);
    let names = |index: usize| two.effects[index].parameters.keys().map(String::as_str).collect::<Vec<_>>();
    assert_eq!((names(0), names(1)), (vec!["amplitude_g", "tau_s"], vec!["amplitude_g"]));
    assert_eq!(two.to_blob().expect("a blob").terms[1].parameters.len(), 2);
    assert!(EffectChoice::of(&two).iter().all(|choice| choice.start.is_some()));
}

#[test]
fn the_unit_of_an_expression_does_not_matter() {
    let tiny = model(vec![EffectChoice::expression("1e-9 * supply_v * temperature_rate")]);
    assert!((residual_ug(&tiny) / residual_ug(&MODEL) - 1.0).abs() < 1e-3);
    let amplitude_g = |model: &Model| model.effects[0].parameters["amplitude_g"];
    assert!((amplitude_g(&tiny) / amplitude_g(&MODEL) * 1e-9 - 1.0).abs() < 1e-3);
}

#[test]
fn what_cannot_be_learnt_is_refused_before_training() {
    let split = RECORDED.campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let refusal = |choice: EffectChoice| {
        let settings = TrainSettings { effects: vec![choice], ..TrainSettings::new(1) };
        check(&RECORDED.campaign, &split, &settings).expect_err("it can't be learnt")
    };
    assert!(matches!(refusal(EffectChoice::named("expression")), TrainError::Effect(EffectError::NoExpression)));
    assert!(matches!(refusal(EffectChoice::expression("pressure_pa")), TrainError::Effect(EffectError::Constant(_))));
    assert!(matches!(
        refusal(EffectChoice::expression("sqrt(-supply_v)")),
        TrainError::Effect(EffectError::Constant(_))
    ));
    let text = refusal(EffectChoice::expression("supply_w * level_g")).to_string();
    assert!(text.contains("column 1") && text.contains("did you mean `supply_v`?"), "{text}");
}

#[test]
fn every_step_of_a_program_has_the_same_bits_there() {
    let (blob, samples) = (example::with_expression(), example::samples(2500));
    let mut instrument = VirtualInstrument::new(example::SERIAL);
    instrument.upload(&blob).expect("uploaded");
    let there = instrument.replay(&samples).expect("readings");
    let mut compensator = Compensator::load(&blob).expect("it is sound");
    let mut plain = Compensator::load(&example::blob()).expect("it is sound");
    let mut works = 0;
    for (sample, there) in samples.iter().zip(there) {
        let here = compensator.compensate(sample);
        assert!(here.same_bits(&there), "{sample:?}");
        works += usize::from(!here.same_bits(&plain.compensate(sample)));
    }
    assert!(works > 1000, "the effect is at work in {works} of the readings");
}

/// The example with one program for its only effect.
fn blob_with(program: &[u8]) -> Blob {
    let program: heapless::Vec<u8, MAX_PROGRAM> = program.iter().copied().collect();
    let term = Term { program, ..example::term(22, &[1e-3, 35.0]) };
    Blob { terms: [term].into_iter().collect(), ..example::blob() }
}

#[test]
fn a_channel_that_was_not_measured_leaves_the_effect_out_and_is_flagged() {
    let mut compensator = Compensator::load(&blob_with(&[0x80, 0x01, 0x12])).expect("it is sound");
    let mut sample = Sample::from_difference(0, 80_000_000, 30_000_000);
    sample.channels[0] = 5_000_000;
    let with = compensator.compensate(&sample);
    sample.channels[0] = Sample::NOT_MEASURED;
    let without = compensator.compensate(&sample);
    assert!((without.acceleration_g - with.acceleration_g - 0.15).abs() < 1e-5, "{with:?} {without:?}");
    assert!(!with.status.contains(Status::CHANNEL_MISSING) && without.status.contains(Status::CHANNEL_MISSING));
}

/// Whatever bytes a calibration carries: refused when it is loaded, or a number or a flag for every sample.
#[test]
fn random_programs_are_refused_or_give_readings() {
    let samples = example::samples(60);
    let mut random = 1_u64;
    let mut next = |below: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let mut sound = 0;
    for _ in 0..20_000 {
        let mut program: Vec<u8> = Vec::new();
        for _ in 0..next(12) {
            let byte =
                [0x01, 0x80, 0x03, 0x05, 0x06, 0x10, 0x11, 0x12, 0x13, 0x20, 0x23, 0x24, next(256) as u8][next(13)];
            program.push(byte);
        }
        match Compensator::load(&blob_with(&program)) {
            Ok(mut compensator) => {
                sound += 1;
                for reading in samples.iter().map(|sample| compensator.compensate(sample)) {
                    assert!(reading.acceleration_g.is_finite() || reading.status.intersects(Status::FATAL));
                }
            }
            Err(LoadError::Program { why, .. }) => assert_eq!(Program::new(&program).err(), Some(why)),
            Err(error) => assert_eq!(error, LoadError::Channel { effect: 22 }, "{program:02x?}"),
        }
    }
    assert!(sound > 1000, "{sound}");
}
