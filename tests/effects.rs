//! Claim: every effect keeps the same contract, and gives the value that its physics says.
//!
//! One loop over the registry, one table with a row per effect. A new effect needs its row here and a line in the golden
//! file; `docs/adding-an-effect.md` has the whole list.

use firmware_core::effect::{self, About, Parameter, Role};
use firmware_core::{Compensator, LoadError, Observation, Real, Terms};
use firmware_sim::virtual_instrument::VirtualInstrument;
use protocol::limits::{MAX_BLOB, MAX_CHANNELS, MAX_NAME, MAX_PARAMETERS, MAX_PROGRAM};
use protocol::{Blob, Sample, Scaling, Status, Term, crc32};
use std::collections::BTreeSet;
use tests::{example, golden};

/// An effect with typical coefficients, and what it then does in [`scene`].
struct Row(&'static str, &'static [f64], Deed<f64>);

/// Temperature of the resonators against the thermometer, °C; frequency difference, Hz; bias, g.
type Deed<R> = [R; 3];

/// Worked out on paper from the formulas' closed forms, with L(r, τ) = r·τ·(1 − exp(−100 s/τ)) for how
/// far a lag trails a signal that has run at the rate r for 100 s.
#[rustfmt::skip]
const WORKED: [Row; 21] = [
    Row("thermal-lag", &[35.0], [-3.298_985_833, 0.0, 0.0]), // −L(0.1 °C/s, 35 s)
    Row("thermal-gradient", &[0.012, 5.0], [0.0, 0.0, 1.199_999_998e-3]), // 0.012·L(0.1, 5)/5
    Row("warm-up", &[140e-6, 600.0], [0.0, 0.0, 9.727_683_171e-6]), // 140 µg·exp(−1600/600)
    Row("thermal-hysteresis", &[10e-6, 4.0], [0.0, 0.0, -40e-6]), // trails by the whole half width
    Row("second-order", &[10e-6], [0.0, 0.0, 2.5e-6]), // 10 µg/g²·(0.5 g)²
    Row("supply-voltage", &[1e-3, 5.0], [0.0, 0.0, 0.055]), // 1 mg/V·(60 − 5) V
    Row("stress-relaxation", &[5e-6, 6000.0], [0.0, 0.0, 4.958_563_854e-5]), // 5 µg/°C·L(0.1, 6000)
    Row("aging", &[1e-6, 30.0, 2.0], [0.0, 0.0, 5.217_391_304e-5]), // order 2: 1 µg·400/(1 + 400/60)
    Row("scale-factor-aging", &[2.0], [0.0, 0.0, 4e-4]), // 2 ppm·400·0.5 g
    Row("third-order", &[0.5e-6], [0.0, 0.0, 6.25e-8]), // 0.5 µg/g³·(0.5 g)³
    Row("cross-axis", &[1e-4, 2e-5], [0.0, 0.0, 6.6e-3]), // (100 + 20·0.5) µg/g·60 g
    Row("misalignment", &[1e-4, 1e-6], [0.0, 0.0, 6.3e-3]), // (100 + 5) µrad·60 g
    Row("vibration-rectification", &[2e-5], [0.0, 0.0, 1.2e-3]), // 20 µg/g²·60 g²
    Row("pressure", &[3e-7, 101_325.0], [0.0, 0.0, -3.037_95e-4]), // 0.3 µg/hPa·(0.6 − 1013.25) hPa
    Row("humidity", &[5e-6, 20.0, 45.0], [0.0, 0.0, -2.493_058_769e-5]), // 5 µg·(60 − L(0.2, 72000) − 45)
    Row("mode-crossing", &[3e-4, 2.0, 27.0, 4.0], [0.0, 0.0, 2.4e-4]), // x = 1 °C: 300 µg·2·1·2/(1 + 4)
    Row("lock-in", &[2.0], [0.0, -2.499_609_5e-2, 0.0]), // 80 − √(80² + 2²) Hz
    Row("g-hysteresis", &[20e-6, 200.0], [0.0, 0.0, -1.573_877_361e-5]), // −20 µg/g·L(0.01 g/s, 200)
    Row("reference-clock", &[0.5], [0.0, -0.016, 0.0]), // −80 Hz·0.5 ppm·400
    Row("self-heating", &[0.2, 900.0], [-3.380_266_308e-2, 0.0, 0.0]), // −0.2 °C·exp(−1600/900)
    Row("expression", &[1e-4, 35.0], [0.0, 0.0, 5.655_404_285e-4]), // 100 µg/(V·°C/s)·60 V·L(0.1, 35)/35
];
/// `channel · temperature_rate`, for effects whose formula comes with the calibration.
const PROGRAM: [u8; 3] = [0x80, 0x03, 0x12];
const WORKED_PRECISION: f64 = 1e-6;

/// One instant: what is measured, and the level, g.
type Moment = (Sample, f32);

/// For 100 s everything runs straight: from 20 to 30 °C, from −0.5 to 0.5 g, the channel from 40 to 60.
/// Then the sensor is 400 days old and was switched on 1600 s ago, and the difference is 80 Hz.
fn scene() -> Vec<Moment> {
    let moment = |second: i32| {
        let mut sample = Sample::from_difference(second as u64 * 1_000_000, 80_000_000, 20_000_000 + second * 100_000);
        sample.power_on_us = (1500 + second as u64) * 1_000_000;
        sample.age_s = Some(400 * 86_400);
        sample.channels[0] = 40_000_000 + i64::from(second) * 200_000;
        (sample, second as f32 * 0.01 - 0.5)
    };
    (0..=100).map(moment).collect()
}

/// Numbers between −1 and 1 that look random and are the same everywhere.
struct Scatter(u64);

impl Scatter {
    fn next(&mut self) -> f64 {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A random walk over temperatures, levels and channel, with pauses, gaps, repetitions, steps back in time,
/// channels and ages that nobody measured, and faults.
fn walk(count: u64) -> Vec<Moment> {
    let mut scatter = Scatter(7);
    let (mut time_us, mut temperature_c, mut level_g, mut channel) = (2_000_000_u64, 25.0, 0.0, 50.0);
    let step = |n: u64| {
        time_us = match n % 97 {
            13 => time_us,
            29 => time_us - 2_000_000,
            41 => time_us + 6_000_000,
            61 => time_us + 30_000_000,
            _ => time_us + 1_000_000,
        };
        temperature_c += 0.8 * scatter.next();
        level_g = (level_g + 0.4 * scatter.next()).clamp(-1.2, 1.2);
        channel += 2.0 * scatter.next();
        let mut sample =
            Sample::from_difference(time_us, ((level_g + 0.91) * 83.5e6) as i64, (temperature_c * 1e6) as i32);
        sample.age_s = (n % 59 > 2).then_some(10_000_000 + n as u32 * 40_000);
        sample.channels = [if n % 53 > 2 { (channel * 1e6) as i64 } else { Sample::NOT_MEASURED }; MAX_CHANNELS];
        sample.faults = if n % 71 == 70 { Status::THERMOMETER_FAULT } else { Status::empty() };
        (sample, level_g as f32)
    };
    (0..count).map(step).collect()
}

fn on_device() -> impl Iterator<Item = &'static About> {
    effect::ALL.iter().copied().filter(|about| about.is_on_device())
}

fn typical(about: &About) -> &'static [f64] {
    let row = WORKED.iter().find(|row| row.0 == about.name);
    row.unwrap_or_else(|| panic!("`{}` needs a row in the table", about.name)).1
}

fn program(about: &About) -> &'static [u8] {
    if about.takes_program() { &PROGRAM } else { &[] }
}

/// What an effect does at every moment, its memory taken along.
fn deeds<R: Real>(about: &About, coefficients: &[f64], moments: &[Moment], real: fn(f64) -> R) -> Vec<Deed<R>> {
    let mut terms = Terms::<R>::new(10_000_000);
    let coefficients = coefficients.iter().map(|value| real(*value));
    terms.push(about.id, 0, 1, coefficients, program(about)).expect("the right coefficients");
    let zeros = example::blob().scaling;
    let deed = |(sample, level_g): &Moment| {
        let (now, level_g) = (Observation::new(sample, &zeros), R::from_f32(*level_g));
        terms.advance(sample, level_g);
        let disturbance = terms.disturbance(&now, level_g);
        [disturbance.temperature_c, disturbance.delta_f_hz, terms.bias_g(&now, level_g)]
    };
    moments.iter().map(deed).collect()
}

fn in_f64(about: &About, coefficients: &[f64], moments: &[Moment]) -> Vec<Deed<f64>> {
    deeds(about, coefficients, moments, |value| value)
}

fn peak(deeds: &[Deed<f64>]) -> Deed<f64> {
    deeds.iter().fold([0.0; 3], |peak, deed| [0, 1, 2].map(|k| f64::max(peak[k], deed[k].abs())))
}

/// A value within a parameter's bounds, at a share of its scale.
fn at(parameter: &Parameter, share: f64) -> f64 {
    let Parameter { role, low, high, .. } = *parameter;
    let value = if role == Role::Shape { low * (high / low).powf(share) } else { low + (high - low) * share };
    value.clamp(low, high)
}

#[test]
fn every_effect_does_what_was_worked_out_on_paper() {
    assert_eq!(on_device().count(), WORKED.len());
    for about in on_device() {
        let Row(name, coefficients, worked) = WORKED.iter().find(|row| row.0 == about.name).expect("a row");
        let found = *in_f64(about, coefficients, &scene()).last().expect("the scene's end");
        for (found, worked) in found.iter().zip(worked) {
            assert!((found - worked).abs() <= WORKED_PRECISION * worked.abs(), "{name}: {found:e} for {worked:e}");
        }
    }
}

/// Names that are stable for ever.
const STABLE: [&str; 22] = [
    "thermal-lag",
    "thermal-gradient",
    "warm-up",
    "thermal-hysteresis",
    "stress-relaxation",
    "aging",
    "scale-factor-aging",
    "second-order",
    "third-order",
    "cross-axis",
    "misalignment",
    "supply-voltage",
    "vibration-rectification",
    "pressure",
    "humidity",
    "mode-crossing",
    "lock-in",
    "turn-on",
    "g-hysteresis",
    "reference-clock",
    "self-heating",
    "expression",
];

#[test]
fn numbers_and_names_are_unique_and_the_stable_ones_are_there() {
    let numbers: Vec<u16> = effect::ALL.iter().map(|about| about.id).collect();
    assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
    assert_eq!(numbers.last(), Some(&effect::HIGHEST));
    let names: BTreeSet<&str> = effect::ALL.iter().map(|about| about.name).collect();
    assert_eq!(names.len(), effect::ALL.len());
    assert!(STABLE.iter().all(|name| names.contains(name)), "{names:?}");
    assert!(names.iter().all(|name| effect::about(name).is_some_and(|about| about.name == *name)));
}

#[test]
fn what_a_person_should_know_is_complete() {
    for about in effect::ALL {
        let texts = [about.summary, about.equation, about.source, about.needs];
        assert!(texts.iter().all(|text| text.len() > 10), "{}", about.name);
        assert!(about.parameters.len() <= MAX_PARAMETERS, "{}", about.name);
        assert!(about.channel.is_none_or(|channel| channel.len() <= MAX_NAME), "{}", about.name);
        for Parameter { name, role, start, low, high, typical, .. } in about.parameters {
            assert!(low < high && (*low..=*high).contains(start), "{}: {name}", about.name);
            assert!((low.abs().max(high.abs()) as f32).is_finite(), "{}: {name}", about.name);
            match role {
                // A fit starts without the effect and may find either sign.
                Role::Amplitude => {
                    assert!(*start == 0.0 && *low < 0.0 && *high > 0.0, "{}: {name}", about.name);
                    // Of a user's own formula nobody knows what is typical.
                    assert!(about.takes_program() || (*typical > 0.0 && typical < high), "{}: {name}", about.name);
                }
                Role::Shape => assert!(*low > 0.0, "{}: {name}", about.name),
                Role::Origin => assert!(about.channel.is_some(), "{}: {name}", about.name),
                Role::Location => {}
            }
        }
    }
}

#[test]
fn an_effect_is_proportional_to_its_amplitudes_and_vanishes_with_them() {
    for about in on_device() {
        let scaled = |factor: f64| {
            let value = |(parameter, value): (&Parameter, &f64)| match parameter.role {
                Role::Amplitude => value * factor,
                _ => *value,
            };
            about.parameters.iter().zip(typical(about)).map(value).collect::<Vec<f64>>()
        };
        if about.parameters.iter().all(|parameter| parameter.role != Role::Amplitude) {
            continue;
        }
        let once = in_f64(about, &scaled(1.0), &walk(500));
        assert!(peak(&once).iter().any(|peak| *peak > 0.0), "{} does nothing", about.name);
        assert!(peak(&in_f64(about, &scaled(0.0), &walk(500))).iter().all(|peak| *peak == 0.0), "{}", about.name);
        // Twice is exact in binary arithmetic.
        let twice: Vec<_> = once.iter().map(|deed| deed.map(|value| 2.0 * value)).collect();
        assert_eq!(in_f64(about, &scaled(2.0), &walk(500)), twice, "{}", about.name);
    }
}

#[test]
fn every_coefficient_within_bounds_gives_numbers_for_every_sample() {
    let mut scatter = Scatter(11);
    let levels = [0.0, -1.0, 1.0, 100.0, -100.0];
    let special = |(sample, level_g): (Sample, &f32)| (sample, *level_g);
    let mut moments = walk(200);
    moments.extend(example::specials().into_iter().zip(levels.iter().cycle()).map(special));
    for about in on_device() {
        for draw in 0..40 {
            let value = |parameter: &Parameter| match draw {
                0 => parameter.low,
                1 => parameter.high,
                _ => at(parameter, 0.5 + 0.5 * scatter.next()),
            };
            let coefficients: Vec<f64> = about.parameters.iter().map(value).collect();
            let deeds = deeds(about, &coefficients, &moments, |value| value as f32);
            let wrong = deeds.iter().position(|deed| deed.iter().any(|value| !value.is_finite()));
            assert!(wrong.is_none(), "{} {coefficients:?}: {:?}", about.name, wrong.map(|at| moments[at]));
        }
    }
}

/// Of the greatest deed in a walk: tens of last places, because steep effects enlarge that of a temperature.
const F32_PRECISION: f64 = 5e-6;

#[test]
fn f32_and_f64_agree_to_rounding() {
    for about in on_device() {
        let rounded: Vec<f64> = typical(about).iter().map(|value| f64::from(*value as f32)).collect();
        let exact = in_f64(about, &rounded, &walk(2000));
        let found = deeds(about, &rounded, &walk(2000), |value| value as f32);
        let peak = peak(&exact);
        for (at, (found, exact)) in found.iter().zip(&exact).enumerate() {
            for k in 0..3 {
                let off = (f64::from(found[k]) - exact[k]).abs();
                assert!(off <= F32_PRECISION * peak[k], "{} at {at}: {off:e} of {:e}", about.name, peak[k]);
            }
        }
    }
}

#[test]
fn nothing_jumps_where_a_shape_or_a_location_moves() {
    const STEPS: u32 = 200;
    for about in on_device() {
        let moves = |role| matches!(role, Role::Shape | Role::Location);
        let usual = peak(&in_f64(about, typical(about), &walk(150)));
        for (index, parameter) in about.parameters.iter().enumerate().filter(|(_, p)| moves(p.role)) {
            let with = |share: f64| {
                let mut coefficients = typical(about).to_vec();
                coefficients[index] = at(parameter, share);
                in_f64(about, &coefficients, &walk(150))
            };
            for step in 0..STEPS {
                let share = f64::from(step) / f64::from(STEPS);
                for (here, there) in with(share).iter().zip(with(share + 1e-9)) {
                    let jump = [0, 1, 2].map(|k| (here[k] - there[k]).abs());
                    assert!((0..3).all(|k| jump[k] <= 1e-5 * (usual[k] + here[k].abs())), "{} {share}", about.name);
                }
            }
        }
    }
}

/// The channel that it reads, if it reads one.
fn channel(about: &About) -> Option<&'static str> {
    about.channel.or(about.takes_program().then_some("supply_v"))
}

/// The example calibration with this effect instead of its own.
fn blob_with(about: &About, coefficients: &[f64]) -> Blob {
    let coefficients: Vec<f32> = coefficients.iter().map(|value| *value as f32).collect();
    let program: heapless::Vec<u8, MAX_PROGRAM> = program(about).iter().copied().collect();
    Blob {
        channels: channel(about).into_iter().map(|name| name.try_into().expect("a short name")).collect(),
        terms: [Term { program, ..example::term(about.id, &coefficients) }].into_iter().collect(),
        ..example::blob()
    }
}

#[test]
fn a_calibration_with_it_survives_storage_and_loads() {
    for about in on_device() {
        let blob = blob_with(about, typical(about));
        let stored = Blob::from_bytes(blob.to_bytes(&mut [0; MAX_BLOB]).expect("it fits")).expect("sound bytes");
        assert_eq!(stored, blob);
        assert!(Compensator::load(&stored).is_ok(), "{}", about.name);
    }
}

#[test]
fn a_wrong_number_of_coefficients_and_a_missing_channel_are_refused() {
    for about in on_device() {
        for found in 0..=MAX_PARAMETERS {
            let refusal = Compensator::load(&blob_with(about, &[1.0; MAX_PARAMETERS][..found])).err();
            let (effect, expected) = (about.id, about.parameters.len());
            let wrong = LoadError::Coefficients { effect, found, expected };
            assert_eq!(refusal, (found != expected).then_some(wrong), "{}", about.name);
        }
        let mut blob = blob_with(about, typical(about));
        blob.channels.clear();
        let missing = channel(about).map(|_| LoadError::Channel { effect: about.id });
        assert_eq!(Compensator::load(&blob).err(), missing, "{}", about.name);
    }
}

#[test]
fn what_no_instrument_can_foretell_is_known_and_refused() {
    let hopeless: Vec<&str> =
        effect::ALL.iter().filter(|about| !about.is_on_device()).map(|about| about.name).collect();
    assert_eq!(hopeless, ["turn-on"]);
    let about = effect::about("turn-on").expect("it is known");
    assert_eq!(Compensator::load(&blob_with(about, &[])).err(), Some(LoadError::UnknownEffect(about.id)));
}

#[test]
fn a_large_effect_is_taken_out_at_the_acceleration_and_not_at_the_level() {
    const HZ_PER_G: f32 = 83.5;
    const ONE_STEP_OF_F32_AT_40_G: f32 = 3.9e-6;
    let about = effect::about("third-order").expect("it is known");
    let mut blob = blob_with(about, &[0.5e-6]);
    blob.scaling = Scaling {
        delta_f_zero_uhz: 0,
        delta_f_gain_per_hz: HZ_PER_G.recip(),
        line_g: [0.0, 1.0, 0.0, 0.0],
        output_g: 0.0,
        ..blob.scaling
    };
    // At 40 g the term adds 32 mg; taken out at 40.032 g instead, it would leave 77 µg.
    let sample = Sample::from_difference(0, (f64::from(HZ_PER_G) * 40.032e6) as i64, 25_000_000);
    let reading = Compensator::load(&blob).expect("it is sound").compensate(&sample);
    assert!((reading.acceleration_g - 40.0).abs() <= 2.0 * ONE_STEP_OF_F32_AT_40_G, "{reading:?}");
}

#[test]
fn the_virtual_instrument_gives_the_hosts_bits_with_every_effect() {
    let samples: Vec<Sample> = walk(600).into_iter().map(|(sample, _)| sample).collect();
    let mut record = String::new();
    for about in on_device() {
        let blob = blob_with(about, typical(about));
        let mut instrument = VirtualInstrument::new(example::SERIAL);
        instrument.upload(&blob).expect("it is sound");
        let mut compensator = Compensator::load(&blob).expect("it is sound");
        let there = instrument.replay(&samples).expect("a perfect line");
        let here: Vec<_> = samples.iter().map(|sample| compensator.compensate(sample)).collect();
        assert!(there.iter().zip(&here).all(|(there, here)| there.same_bits(here)), "{}", about.name);
        let bits: Vec<u8> = here.iter().flat_map(|reading| reading.acceleration_g.to_bits().to_le_bytes()).collect();
        record += &format!("{:2} {} {:08x}\n", about.id, about.name, crc32(&bits));
    }
    // A released formula is frozen: a better one gets a new number.
    golden::check("effects-v1.txt", record.as_bytes());
}
