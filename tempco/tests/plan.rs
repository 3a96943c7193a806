//! A campaign that can't tell two effects apart, the recording that `plan` proposes, and what the diagnosis says of both.

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A static calibration that shows neither lag nor warm-up.
const CALIBRATION: &str = r#"
name = "calibration"
columns = ["power_on_s"]

[[run]]
name = "full"
kind = "full"
repeat = 2
positions_deg = [0, 30, 90, 150, 180, 210, 270, 330]
order = "random"
settle_s = 5
dwell_s = 20
record_every_s = 4

[[run]]
name = "tumble"
kind = "tumble"
repeat = 2
temperatures_c = [-30, -10, 10, 30, 50]
record_every_s = 3
"#;

/// Little flicker and walk.
const NOISE: &str = "
[noise]
flicker_ug = 0.3
random_walk_ug_per_sqrt_s = 0.002
";

/// Over ten degrees the bias has one slope: entering the map late is the same as a bias in proportion to the rate.
const NARROW_RAMP: &str = r#"
[[run]]
name = "ramp"
kind = "ramp"
repeat = 2
from_c = 20
to_c = 30
record_every_s = 15
"#;

/// At one temperature what warms up is the same as what settles electrically.
const ZERO: &str = r#"
[[run]]
name = "zero"
kind = "zero"
repeat = 3
record_every_s = 10
"#;

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = run(folder, arguments);
    serde_json::from_str(&output).expect("JSON")
}

fn run(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    let output =
        command.current_dir(folder).env("NO_COLOR", "1").args(arguments).assert().success().get_output().clone();
    String::from_utf8(output.stdout).expect("text")
}

/// Records `scenario` with the hidden effect.
fn record(folder: &Path, scenario: &str, hidden: &str, seed: &str, file: &str) {
    fs::write(folder.join("scenario.toml"), format!("{scenario}\n{NOISE}\n{hidden}")).expect("a file");
    run(folder, &["simulate", "scenario.toml", "--seed", seed, "-o", file]);
}

/// Trains, and returns the first finding and what it is confounded with.
fn diagnosed(folder: &Path, data: &[&str]) -> (String, Vec<String>) {
    let train = [&["train"], data, &["-o", "model.toml", "--restarts", "3"]].concat();
    run(folder, &train);
    let diagnosis = json(folder, &[&["diagnose", "model.toml", "--json"], data].concat());
    let first = &diagnosis["findings"][0];
    let confounded = first["confounded_with"].as_array().expect("a list").iter();
    let name = |value: &Value| value.as_str().expect("a name").to_owned();
    (name(&first["effect"]), confounded.map(name).collect())
}

/// Hides an effect in a campaign that can't tell it from another, makes the proposed recording, and looks again.
fn resolved(part: &str, hidden: &str, effect: &str, other: &str) -> Value {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    record(folder, &format!("{CALIBRATION}{part}"), hidden, "3", "old.csv");
    let (first, confounded) = diagnosed(folder, &["old.csv"]);
    let mut both: Vec<&str> = std::iter::once(&first).chain(&confounded).map(String::as_str).collect();
    both.sort_unstable();
    let mut expected = [effect, other];
    expected.sort_unstable();
    assert_eq!(both, expected, "the campaign was to be ambiguous");

    let plan = json(folder, &["plan", "model.toml", "old.csv", "-o", "next", "--json"]);
    let file = plan["file"].as_str().expect("a file");
    let scenario = fs::read_to_string(folder.join(file)).expect("the proposal");
    record(folder, &scenario, hidden, "9", "new.csv");
    let (named, confounded) = diagnosed(folder, &["old.csv", "new.csv"]);
    assert_eq!((named.as_str(), confounded), (effect, vec![]), "after {file}");
    plan
}

#[test]
fn a_lag_is_told_from_a_gradient_by_the_proposed_recording() {
    let plan = resolved(NARROW_RAMP, "[effects.thermal-lag]\ntau_s = 35", "thermal-lag", "thermal-gradient");
    assert_eq!(plan["reason"], "ambiguous");
    let so_far = plan["so_far"][0]["sigma"].as_f64().expect("a number");
    let best = &plan["proposals"][0];
    assert!(so_far < 5.0 && best["sigma"].as_f64() > Some(50.0) && best["decides"] == 1, "{plan:#}");
    assert!(best["recording"].as_str().is_some_and(|name| name.contains("ramp")), "{best:#}");
}

#[test]
fn electronics_that_settle_are_told_from_heat_by_the_proposed_recording() {
    let plan = resolved(ZERO, "[effects.warm-up]\nbias_ug = 140\ntau_s = 600", "warm-up", "self-heating");
    assert_eq!(plan["proposals"][0]["recording"], "power-cycles", "{plan:#}");
}

#[test]
fn effects_that_are_asked_for_are_planned_for_and_what_can_not_be_says_what_to_do() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    record(folder, CALIBRATION, "", "3", "old.csv");
    run(folder, &["train", "old.csv", "-o", "model.toml", "--restarts", "3"]);
    let text = run(folder, &["plan", "model.toml", "old.csv", "--effects", "supply-voltage"]);
    assert!(text.starts_with("Is there supply-voltage, or not?") && text.contains("supply-sweep"), "{text}");
    assert!(text.contains("Write supply_v into the old files too"), "{text}");
    // What it says to do next can be done.
    let next = text.lines().find_map(|line| line.strip_prefix("Next:  tempco ")).expect("a next step");
    assert!(next.ends_with("# writes supply-sweep as a scenario"), "{next}");
    let next = next.split_once('#').map_or(next, |(command, _)| command);
    let options = ["--effects", "supply-voltage"];
    let text = run(folder, &[&next.split_whitespace().collect::<Vec<_>>()[..], &options].concat());
    assert!(
        text.contains("supply-sweep is written to next/supply-sweep.toml.\nRehearse it:  tempco simulate next/"),
        "{text}"
    );
    assert!(
        text.contains("tempco train old.csv new.csv -o model2.toml && tempco diagnose model2.toml old.csv new.csv"),
        "{text}"
    );
    let rehearsed = run(folder, &["simulate", "next/supply-sweep.toml", "-o", "new.csv"]);
    assert!(rehearsed.contains("new.csv"), "{rehearsed}");
    let text = run(folder, &["plan", "model.toml", "old.csv"]);
    assert!(text.contains("This campaign could not show") && text.contains("vibration-sweep"), "{text}");
    for (arguments, place) in [(["--effects", "thermal-leg"], "thermal-leg"), (["--hours", "0.5"], "--hours 2")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
        let command = command.current_dir(folder).env("NO_COLOR", "1").args(["plan", "model.toml", "old.csv"]);
        let output = command.args(arguments).assert().code(2).get_output().stderr.clone();
        let text = String::from_utf8_lossy(&output);
        assert!(text.starts_with("error:") && text.contains(place) && text.contains("help:"), "{text}");
    }
}
