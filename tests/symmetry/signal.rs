//! The unit of the signal: converted while it is read, or kept.

use super::chain::{Answer, answer, changed, measured, near, same};
use std::fmt::Write;
use std::fs;
use tempfile::TempDir;
use trainer::campaign::{Campaign, Measured, Quantity, ReadOptions};

/// The campaign as a table whose signal, and the sum of the frequencies beside it, are so many times a hertz's number;
/// every digit is kept.
fn table(campaign: &Campaign, power: i32) -> String {
    let mut text = "run,kind,time_s,temperature_c,fd,fs,reference_g,power_on_s\n".to_owned();
    let digits = |micro: i128, power: i32| format!("{micro}e{}", power - 6);
    for run in &campaign.runs {
        for row in &run.rows {
            let sample = &row.sample;
            let sum_uhz = i128::from(sample.sum_f_uhz.expect("it was measured"));
            writeln!(
                text,
                "{},{},{},{},{},{},{},{}",
                run.name,
                run.kind,
                digits(sample.time_us.into(), 0),
                digits(sample.temperature_uc.into(), 0),
                digits(sample.delta_f_uhz.into(), power),
                digits(sum_uhz, power),
                row.reference_g,
                digits(sample.power_on_us.into(), 0),
            )
            .expect("a string takes it");
        }
    }
    text
}

fn read(text: &str, options: &ReadOptions) -> Campaign {
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("campaign.csv");
    fs::write(&file, text).expect("written");
    Campaign::read(&[file], options).expect("a campaign")
}

fn mapped(pairs: &[(&str, &str)]) -> ReadOptions {
    let map = pairs.iter().map(|&(name, text)| (name.to_owned(), text.to_owned())).collect();
    ReadOptions { map, ..ReadOptions::default() }
}

#[test]
fn a_signal_converted_while_it_is_read_gives_the_same_campaign_to_the_last_bit() {
    let campaign = measured(&["thermal-lag"], 1);
    let hertz = read(&table(&campaign, 0), &mapped(&[("delta_f_hz", "fd"), ("sum_f_hz", "fs")]));
    for (power, factor) in [(-3, "*1000"), (3, "*0.001"), (-6, "*1e6"), (3, "/1000")] {
        let [signal, sum] = ["fd", "fs"].map(|column| format!("{column}{factor}"));
        let other = read(&table(&campaign, power), &mapped(&[("delta_f_hz", &signal), ("sum_f_hz", &sum)]));
        assert_eq!((hertz.hash(), &hertz.channels), (other.hash(), &other.channels), "{factor}");
    }
}

/// Read with a signal of its own unit; the sum beside it in hertz, as its name says.
fn in_unit(campaign: &Campaign, unit: &str, power: i32) -> Campaign {
    let signal = Measured { column: "fd".to_owned(), unit: unit.to_owned() };
    let hertz = format!("fs*1e{}", -power);
    let options = ReadOptions { signal: Some(signal), ..mapped(&[("sum_f_hz", &hertz)]) };
    read(&table(campaign, power), &options)
}

#[test]
fn the_unit_of_the_signal_does_not_matter_with_the_sum_of_the_frequencies_beside_it() {
    for (what, campaign) in [("nothing", measured(&[], 6)), ("a lag", measured(&["thermal-lag"], 1))] {
        let one = answer(&in_unit(&campaign, "Hz", 0));
        let other = in_unit(&campaign, "mHz", 3);
        let sums = other.rows().filter(|row| row.sample.sum_f_uhz.is_some()).count();
        assert_eq!((sums, other.channels.len()), (other.row_count(), 0), "{what}");
        same(&format!("{what} in mHz"), &one, &answer(&other), 1.0, |_| 0);
    }
}

#[test]
fn a_signal_in_kilohertz_is_kept_to_a_millihertz_and_says_the_same() {
    let campaign = measured(&["thermal-lag"], 1);
    let (one, other) = (answer(&in_unit(&campaign, "Hz", 0)), answer(&in_unit(&campaign, "kHz", -3)));
    // A step of 1 mHz is 2.4 µg here: the noise is larger, and evidence smaller for it.
    let names = |one: &Answer| one.diagnosis.findings.iter().map(|one| one.effect.clone()).collect::<Vec<_>>();
    assert_eq!((one.diagnosis.verdict, names(&one)), (other.diagnosis.verdict, names(&other)));
    near("residual", one.residual_ug, other.residual_ug);
    let tau_s = |one: &Answer| one.diagnosis.findings[0].parameters["tau_s"].value;
    near("tau_s", tau_s(&one), tau_s(&other));
}

#[test]
fn the_unit_of_the_signal_does_not_matter_without_a_sum() {
    let mut campaign = measured(&["thermal-hysteresis"], 3);
    campaign = changed(&campaign, "g", |row| row.sample.sum_f_uhz = None);
    let one = answer(&campaign);
    for (unit, factor) in [("mHz", 1000), ("ppm", 7)] {
        let mut other = changed(&campaign, "g", |row| row.sample.delta_f_uhz *= factor);
        let quantity = Quantity { signal_unit: unit.to_owned(), ..other.quantity.clone() };
        other = Campaign::new(other.runs, other.channels, quantity);
        let (mut one, other) = (Answer { diagnosis: one.diagnosis.clone(), ..one }, answer(&other));
        if !unit.ends_with("Hz") {
            // What is made of frequencies can't be missing there, and is said to be so.
            one.diagnosis.unobservable.clone_from(&other.diagnosis.unobservable);
        }
        same(unit, &one, &other, 1.0, |_| 0);
    }
}
