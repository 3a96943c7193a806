//! What every effect must do, and where each one shows.

use super::one_effect::OneEffect;
use super::*;

#[test]
fn names_are_those_of_the_parameters() {
    let mut effects = Effects::default();
    for name in Effects::NAMES {
        assert!(effects.switch_on(name, 1.0), "{name}");
    }
    assert_eq!(effects.active(), Effects::NAMES);
    assert_eq!(effects.check(), Ok(()));
    assert!(!effects.switch_on("no-such-effect", 1.0));
}

#[test]
fn every_variation_is_one_that_a_scenario_may_state() {
    for seed in 0..100 {
        let mut effects = Effects::default();
        for name in Effects::NAMES {
            effects.switch_on_varied(name, 1.0, seed);
        }
        assert_eq!(effects.check(), Ok(()), "seed {seed}");
        assert_ne!(effects.mode_crossing, Some(ModeCrossing::default()));
    }
}

/// The ratio of the shift of Δf to that of the mean frequency names the family of an effect.
#[test]
fn every_effect_has_the_fingerprint_of_its_family() {
    let table: [(&str, OneEffect, Option<f64>); 8] = [
        ("thermal-lag", excited(&ThermalLag::default()), Some(-0.032)),
        ("thermal-gradient", excited(&ThermalGradient::default()), None),
        ("thermal-hysteresis", excited(&ThermalHysteresis::default()), Some(0.03)),
        ("stress-relaxation", excited(&StressRelaxation::default()), Some(0.03)),
        ("pressure", excited(&Pressure::default()), Some(0.03)),
        ("humidity", excited(&Humidity::default()), Some(0.03)),
        ("supply-voltage", excited(&SupplyVoltage::default()), Some(0.1)),
        ("reference-clock", excited(&ReferenceClock { offset_ppm: 9.0, ..ReferenceClock::default() }), Some(0.0018)),
    ];
    for (name, alone, ratio) in table {
        let seen = alone.look();
        match ratio {
            // Within 5 %: the ratios are stated with two digits and drift with temperature.
            Some(ratio) => assert!((seen.delta_hz / seen.mean_hz / ratio - 1.0).abs() < 0.05, "{name}: {seen:?}"),
            None => assert!((seen.delta_hz / seen.mean_hz).abs() > 20.0, "{name}: {seen:?}"),
        }
    }
}

/// What acts like an acceleration hardly moves the mean: 0.25 Hz/g against 83.5 Hz/g.
#[test]
fn what_acts_like_an_acceleration_looks_like_one() {
    let each = [
        excited(&WarmUp::default()),
        excited(&TurnOn::default()),
        excited(&Aging::default()),
        excited(&Misalignment::default()),
        excited(&CrossAxis::default()),
        excited(&VibrationRectification::default()),
        excited(&GHysteresis::default()),
        excited(&Telegraph::default()),
    ];
    for alone in each {
        let seen = alone.look();
        assert!(seen.bias_ug.abs() > 0.1, "{seen:?}");
        assert!((seen.mean_hz / seen.delta_hz - 0.003).abs() < 0.0005, "{seen:?}");
    }
}

/// Ten days of everything: warmer, wetter, thinner air, more volts, shaken, and turned.
fn excited(parameters: &impl Switch) -> OneEffect {
    let mut alone = OneEffect::new(parameters);
    alone.apply(90.0);
    alone.now.age_days = 10.0;
    alone.now.humidity_pct = 80.0;
    alone.now.pressure_pa = 60_000.0;
    alone.now.supply_v = 5.2;
    alone.now.vibration_g2 = 9.0;
    alone.ramp(1.0, 60.0);
    alone.apply(0.0);
    alone
}
