//! Claim: everything that concerns an instrument can be tried from the command line, with no hardware.

use assert_cmd::Command;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};
use tempfile::TempDir;

const SMALL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.csv");
const SMALL_SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.toml");

fn tempco(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    command.current_dir(folder).env("NO_COLOR", "1");
    command
}

fn said(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let output = tempco(folder).args(arguments).assert().code(code).get_output().clone();
    String::from_utf8([output.stdout, output.stderr].concat()).expect("text")
}

fn json(folder: &Path, code: i32, arguments: &[&str]) -> serde_json::Value {
    let text = said(folder, code, arguments);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// A folder with two models of the small campaign.
fn trained() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    for (file, seed) in [("model.toml", "1"), ("other.toml", "2")] {
        said(folder.path(), 0, &["train", SMALL, "-o", file, "--restarts", "2", "--seed", seed]);
    }
    folder
}

/// A running virtual instrument; dropping it switches it off as a power cut does.
struct Served {
    process: Child,
    port: String,
}

impl Served {
    fn start(folder: &Path, options: &[&str]) -> Self {
        let mut process = std::process::Command::new(env!("CARGO_BIN_EXE_tempco"))
            .current_dir(folder)
            .env("NO_COLOR", "1")
            .args(["device", "serve", "--scenario", SMALL_SCENARIO, "--serial", "SN-7"])
            .args(options)
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("piped")).read_line(&mut line).expect("a line");
        let port = line.strip_prefix("Instrument SN-7 at ").and_then(|rest| rest.split(';').next());
        Self { port: port.unwrap_or_else(|| panic!("{line}")).to_owned(), process }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

const ANY: [&str; 2] = ["--tcp", "127.0.0.1:0"];

#[test]
fn an_instrument_is_flashed_watched_verified_and_taken_back() {
    let folder = trained();
    let folder = folder.path();
    let instrument = Served::start(folder, &ANY);
    let port = instrument.port.as_str();
    assert!(said(folder, 0, &["device", "identify", port]).starts_with("Instrument SN-7: "));
    assert_eq!(json(folder, 1, &["device", "status", port, "--json"])["source"], "nothing");
    assert!(said(folder, 0, &["device", "monitor", port, "--count", "1"]).contains("uncalibrated"));
    assert!(said(folder, 1, &["verify", "model.toml", SMALL, "--on", port]).contains("another calibration"));

    assert_eq!(json(folder, 0, &["flash", "model.toml", "--to", port, "--json"])["kept"], "for-good");
    assert!(
        said(folder, 0, &["flash", "other.toml", "--to", port]).contains("stored, in use, and reads back the same")
    );
    let state = json(folder, 0, &["device", "status", port, "--json"]);
    assert_eq!((&state["sequence"], &state["can_roll_back"]), (&2.into(), &true.into()), "{state}");
    assert_eq!(state["erases"], serde_json::json!([1, 1]));
    let identical = json(folder, 0, &["verify", "other.toml", SMALL, "--on", port, "--json"]);
    assert_eq!((&identical["samples"], &identical["identical"]), (&2736.into(), &2736.into()));

    said(folder, 0, &["device", "read", port, "-o", "read.bin"]);
    said(folder, 0, &["export", "other.toml", "-o", "other.bin"]);
    assert!(
        fs::read(folder.join("read.bin")).expect("written") == fs::read(folder.join("other.bin")).expect("written")
    );

    assert!(said(folder, 0, &["device", "rollback", port]).starts_with("Back at calibration "));
    assert!(said(folder, 0, &["verify", "model.toml", SMALL, "--on", port]).starts_with("2736 of 2736"));
    assert!(said(folder, 1, &["device", "rollback", port]).contains("no earlier calibration"));
}

#[test]
fn readings_and_samples_come_line_by_line() {
    let folder = trained();
    let folder = folder.path();
    let instrument = Served::start(folder, &ANY);
    let port = instrument.port.as_str();
    said(folder, 0, &["flash", "model.toml", "--to", port]);
    let text = said(folder, 0, &["device", "monitor", port, "--count", "2", "--json"]);
    let readings: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect();
    assert_eq!(readings.len(), 2, "{text}");
    for (number, reading) in readings.iter().enumerate() {
        assert_eq!(reading["number"], number);
        assert!(reading["acceleration_g"].as_f64().expect("calibrated").abs() < 2.0, "{reading}");
    }
    let text = said(folder, 0, &["device", "raw", port, "--count", "2"]);
    let fields: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(fields, [5, 5, 5], "{text}");
    assert!(said(folder, 2, &["device", "monitor", port, "--every-ms", "1"]).contains("every 10 to 3600000 ms"));
}

#[test]
fn what_was_flashed_outlives_the_power() {
    let folder = trained();
    let folder = folder.path();
    let options = ["--tcp", "127.0.0.1:0", "--flash", "instrument.flash"];
    let instrument = Served::start(folder, &options);
    said(folder, 0, &["flash", "model.toml", "--to", &instrument.port]);
    let before = json(folder, 0, &["device", "status", &instrument.port, "--json"]);
    drop(instrument);
    let instrument = Served::start(folder, &options);
    let after = json(folder, 0, &["device", "status", &instrument.port, "--json"]);
    assert_eq!(after["calibration"], before["calibration"]);
    assert_eq!(after["source"], "committed");
}

#[test]
fn an_instrument_with_the_factorys_key_takes_signed_calibrations_only() {
    let folder = trained();
    let folder = folder.path();
    assert!(said(folder, 0, &["device", "keygen", "-o", "factory"]).contains("factory.key signs"));
    assert!(said(folder, 2, &["device", "keygen", "-o", "factory"]).contains("never overwritten"));
    let instrument = Served::start(folder, &["--tcp", "127.0.0.1:0", "--key", "factory.pub"]);
    let port = instrument.port.as_str();
    assert!(said(folder, 1, &["flash", "model.toml", "--to", port]).contains("not signed"));
    said(folder, 0, &["device", "keygen", "-o", "thief"]);
    assert!(said(folder, 1, &["flash", "model.toml", "--to", port, "--sign", "thief.key"]).contains("not signed"));
    said(folder, 0, &["export", "model.toml", "--sign", "factory.key", "-o", "signed.bin"]);
    said(folder, 0, &["flash", "signed.bin", "--to", port]);
    assert!(said(folder, 0, &["verify", "model.toml", SMALL, "--on", port]).starts_with("2736 of 2736"));
    assert!(said(folder, 0, &["inspect", "signed.bin"]).contains("  signed\n"));
}

#[test]
fn the_identity_of_an_instrument_is_written_where_the_image_looks_for_it() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let text = said(folder, 0, &["device", "provision", "--serial", "SN-0042", "-o", "identity.hex"]);
    assert!(text.contains("for address 0x080a0000"), "{text}");
    let hex = fs::read_to_string(folder.join("identity.hex")).expect("written");
    assert!(hex.starts_with(":02000004080AE8\n:10000000534E2D30303432FF"), "{hex}");
    assert!(said(folder, 2, &["device", "provision", "--serial", "a b"]).contains("without blanks"));
}

#[test]
fn what_is_missing_is_said_in_one_line() {
    let folder = trained();
    let folder = folder.path();
    let text = said(folder, 2, &["verify", "model.toml", SMALL, "--on", "qemu:nowhere.elf"]);
    assert!(text.contains("no such image") && text.contains(".ci/firmware"), "{text}");
    let text = said(folder, 2, &["device", "identify", "tcp:127.0.0.1:1"]);
    assert!(text.contains("tempco device serve"), "{text}");
    let text = said(folder, 2, &["device", "identify", "nowhere"]);
    assert!(text.contains("nowhere: "), "{text}");
    assert!(said(folder, 2, &["device", "identify", "sim"]).contains("tempco device serve"));
}

#[cfg(unix)]
#[test]
fn a_pseudo_terminal_is_a_port_like_any_other_and_control_c_ends_in_order() {
    let folder = trained();
    let folder = folder.path();
    let mut instrument = Served::start(folder, &["--pty"]);
    assert!(instrument.port.starts_with("/dev/"), "{}", instrument.port);
    said(folder, 0, &["flash", "model.toml", "--to", &instrument.port]);
    assert!(said(folder, 0, &["device", "monitor", &instrument.port, "--count", "2"]).contains("status"));
    let id = instrument.process.id().to_string();
    std::process::Command::new("kill").args(["-INT", &id]).status().expect("a signal");
    assert_eq!(instrument.process.wait().expect("it ends").code(), Some(0));
}
