//! What a user hands over as text: files, and what stands on the command line.

use crate::example;
use firmware_core::Compensator;
use firmware_sim::scenario::Scenario;
use firmware_sim::seal::{CampaignDigest, SealedTruth, open, seal};
use std::cell::RefCell;
use std::path::PathBuf;
use tempfile::TempDir;
use trainer::campaign::{Campaign, ReadOptions};
use trainer::expression::{Expression, print};
use trainer::model::Model;

#[path = "../../../tempco/src/hex/records.rs"]
mod hex;

thread_local! {
    static FOLDER: RefCell<TempDir> = RefCell::new(tempfile::tempdir().expect("a folder for temporary files"));
}

fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = FOLDER.with_borrow(|folder| folder.path().join(name));
    std::fs::write(&path, bytes).expect("the temporary folder is writable");
    path
}

/// Whatever a campaign's file contains: refused with a sentence, or rows of usable numbers in rising time.
///
/// # Panics
/// If that does not hold.
pub fn campaign(bytes: &[u8]) {
    usable_or_refused(file("campaign.csv", bytes), &ReadOptions::default());
}

/// Whatever stands behind `--map NAME=`, for each name: as for a campaign.
///
/// # Panics
/// If that does not hold.
pub fn mapping(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    const TABLE: &[u8] = b"run,kind,t [ms],f,T,ref,big,tiny\n\
        a,full,0,76.5,20,0,1e300,1e-300\na,full,1000,76,20.5,1,-9e18,0\na,full,2000,-75.000001,-21,-1,0.5,-4e-320\n";
    let path = file("table.csv", TABLE);
    let usual = [("time_s", "t [ms] * 0.001"), ("delta_f_hz", "f"), ("temperature_c", "T"), ("reference_g", "ref")];
    for name in ["time_s", "delta_f_hz", "temperature_c", "reference_g", "sum_f_hz", "age_days", "supply_v", "run"] {
        // Of two mappings to one name the later one counts.
        let map = usual.into_iter().chain([(name, text)]).map(|(name, text)| (name.to_owned(), text.to_owned()));
        usable_or_refused(path.clone(), &ReadOptions { map: map.collect(), ..ReadOptions::default() });
    }
}

fn usable_or_refused(path: PathBuf, options: &ReadOptions) {
    match Campaign::read(&[path], options) {
        Ok(campaign) => {
            assert!(campaign.rows().all(|row| row.reference_g.is_finite()));
            for run in &campaign.runs {
                assert!(run.rows.windows(2).all(|pair| pair[0].sample.time_us < pair[1].sample.time_us));
            }
        }
        Err(error) => assert!(error.to_string().len() > 20, "{error}"),
    }
}

/// Whatever a user writes as an effect: refused with a place within it, or a program that runs and can be written out.
///
/// # Panics
/// If that does not hold.
pub fn expression(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let channels = ["supply_v", "pressure_pa"].map(str::to_owned);
    match Expression::parse(text, &channels) {
        Ok(expression) => {
            let printed = print(expression.code(), &channels).expect("a sound program has a text");
            let again = Expression::parse(&printed, &channels).expect("what was printed is read");
            assert_eq!(again.code(), expression.code(), "{text} became {printed}");
        }
        Err(error) => assert!(error.column >= 1 && error.column <= text.chars().count() + 1, "{error}"),
    }
}

/// Whatever a model's file contains: refused with a sentence, or a model that is written as it was read, and either
/// fits a device, giving numbers or saying why not, or is refused for it with a sentence.
///
/// # Panics
/// If that does not hold.
pub fn model(bytes: &[u8]) {
    let model = match Model::read(&file("model.toml", bytes)) {
        Ok(model) => model,
        Err(error) => return assert!(error.to_string().len() > 20, "{error}"),
    };
    let text = model.to_text();
    let again = Model::read(&file("again.toml", text.as_bytes())).expect("what was written is read");
    // Compared as text: a number may be a NaN, which differs from itself.
    assert_eq!(again.to_text(), text);
    match model.to_blob() {
        Ok(blob) => {
            let mut compensator = Compensator::load(&blob).expect("a model's blob is loaded");
            crate::fuzz::readings_are_numbers_or_say_why(&mut compensator, &example::samples(60));
        }
        Err(error) => assert!(error.to_string().len() > 10, "{error}"),
    }
}

/// Whatever a scenario's file contains: refused with a sentence, or written as it was read.
///
/// # Panics
/// If that does not hold.
pub fn scenario(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match Scenario::from_toml(text) {
        Ok(scenario) => {
            assert!(scenario.rows().is_ok_and(|rows| rows > 0));
            assert_eq!(Scenario::from_toml(&scenario.to_toml()), Ok(scenario));
        }
        Err(error) => assert!(error.to_string().len() > 20, "{error}"),
    }
}

/// Whatever a sealed truth contains: refused with a sentence; and every truth comes out as it was sealed.
///
/// # Panics
/// If that does not hold.
pub fn sealed_truth(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let campaign = CampaignDigest::of([b"run,kind\n"]);
    match open(text, &campaign) {
        Ok(truth) => comes_out_as_it_was_sealed(&truth, &campaign),
        Err(error) => assert!(error.to_string().len() > 20, "{error}"),
    }
    // The checksum keeps nearly everything out.
    if let Ok(truth) = toml::from_str(text) {
        comes_out_as_it_was_sealed(&truth, &campaign);
    }
}

fn comes_out_as_it_was_sealed(truth: &SealedTruth, campaign: &CampaignDigest) {
    let opened = open(&seal(truth, campaign), campaign).expect("what was sealed is opened");
    // Compared as text: a number may be a NaN, which differs from itself.
    assert_eq!(toml::to_string(&opened), toml::to_string(truth));
}

/// Whatever a programmer's file contains: refused with a line of it, or bytes that come back when they are written.
///
/// # Panics
/// If that does not hold.
pub fn intel_hex(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match hex::pieces(text) {
        Ok(pieces) => {
            for (_, bytes) in pieces {
                // Longer ones would cross a border of 64 KiB, which no piece of ours does.
                let bytes = bytes[..bytes.len().min(4096)].to_vec();
                let written = hex::text(&[(0x0800_F000, &bytes)]).expect("short records");
                let read = hex::pieces(&written).expect("what was written is read");
                assert_eq!(read, if bytes.is_empty() { vec![] } else { vec![(0x0800_F000, bytes)] });
            }
        }
        Err((line, _)) => assert!(line >= 1 && line <= text.lines().count() + 1),
    }
}
