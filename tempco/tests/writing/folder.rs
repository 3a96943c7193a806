//! A folder that was worked in, and the commands that write files into it.

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

pub const SMALL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.csv");
pub const SMALL_SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.toml");
pub const TEMPCO: &str = env!("CARGO_BIN_EXE_tempco");

pub fn said(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let mut command = Command::new(TEMPCO);
    command.current_dir(folder).env("NO_COLOR", "1").args(arguments);
    let output = command.assert().code(code).get_output().clone();
    String::from_utf8([output.stdout, output.stderr].concat()).expect("text")
}

/// A folder with a campaign, a model of it, and what is made of that.
pub fn worked_in() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    fs::copy(SMALL, folder.path().join("small.csv")).expect("copied");
    let run = |arguments: &[&str]| drop(said(folder.path(), 0, arguments));
    run(&["train", "small.csv", "-o", "model.toml", "--restarts", "1"]);
    run(&["export", "model.toml", "-o", "calibration.bin"]);
    run(&["export", "model.toml", "-o", "calibration.hex"]);
    run(&["device", "keygen", "-o", "factory"]);
    run(&["device", "provision", "--serial", "SN-1", "-o", "identity.hex"]);
    run(&["compare", "model.toml", "small.csv", "--report", "report.html"]);
    run(&["simulate", SMALL_SCENARIO, "--blind", "-o", "campaign.csv"]);
    folder
}

/// Every file of a folder and of those within it, and what it holds.
pub fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            all.extend(contents(&entry.path()).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else if entry.path().is_file() {
            all.insert(name, fs::read(entry.path()).expect("readable"));
        }
    }
    all
}

/// Every command that writes a file, with FILE for its name.
pub const WRITERS: [&[&str]; 9] = [
    &["train", "small.csv", "-o", "FILE", "--restarts", "1"],
    &["add", "model.toml", "warm-up", "small.csv", "-o", "FILE"],
    &["remove", "model.toml", "warm-up", "small.csv", "-o", "FILE"],
    &["export", "model.toml", "-o", "FILE"],
    &["export", "model.toml", "--sign", "factory.key", "-o", "FILE"],
    &["compare", "model.toml", "small.csv", "--report", "FILE"],
    &["simulate", SMALL_SCENARIO, "-o", "FILE"],
    &["simulate", SMALL_SCENARIO, "--blind", "-o", "FILE"],
    &["device", "provision", "--serial", "SN-1", "-o", "FILE"],
];

pub fn writing<'a>(writer: &[&'a str], file: &'a str) -> Vec<&'a str> {
    writer.iter().map(|word| if *word == "FILE" { file } else { word }).collect()
}
