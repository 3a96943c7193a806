//! Claim: what a model was trained with stands in its file and serves every later command, and no command makes a model
//! that can't measure.

use assert_cmd::Command;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SCALE_FACTOR_HZ_PER_G: f64 = 420.0;

fn tempco(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    command.current_dir(folder).env("NO_COLOR", "1").args(arguments);
    command
}

fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = tempco(folder, arguments).assert().success().get_output().stdout.clone();
    String::from_utf8(output).expect("text")
}

fn told(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = tempco(folder, arguments).assert().code(code).get_output().stderr.clone();
    String::from_utf8(output).expect("text")
}

fn residual_ug(folder: &Path, arguments: &[&str]) -> f64 {
    let json: serde_json::Value = serde_json::from_str(&succeeds(folder, arguments)).expect("JSON");
    json["residual_ug"].as_f64().expect("a residual")
}

/// A sensor at rest under `applied_g` in a chamber, logged by a stranger: time in ms, names of his own, temperatures in
/// tenths. What lags is the resonator, by 60 s.
fn still(applied_g: f64) -> String {
    let mut text = String::from("record;t_ms;FreqDiff;T10;operator\n");
    for run in 1..=3 {
        let mut resonator_c = -20.0;
        for row in 0..240 {
            let phase = f64::from(row) / 240.0;
            let temperature_c = 20.0 - 40.0 * (phase * std::f64::consts::TAU).cos();
            resonator_c += (temperature_c - resonator_c) * (1.0 - (-30.0_f64 / 60.0).exp());
            let noise_hz = f64::from((row * 7919 + run * 104_729) % 1009) / 1009.0 * 4e-3 - 2e-3;
            let delta_f_hz = 76.0 + SCALE_FACTOR_HZ_PER_G * applied_g + 0.03 * resonator_c + noise_hz;
            let (time_ms, tenths) = (row * 30_000, temperature_c * 10.0);
            writeln!(text, "flat-{run};{time_ms};{delta_f_hz:.6};{tenths:.3};Ann").expect("a string takes it");
        }
    }
    text
}

const AS_LOGGED: [&str; 12] = [
    "--map",
    "run=record",
    "--map",
    "time_s=t_ms*0.001",
    "--map",
    "delta_f_hz=FreqDiff",
    "--map",
    "temperature_c=T10*0.1",
    "--ignore",
    "operator",
    "--constant-reference",
    "0",
];

fn files() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    fs::write(folder.path().join("still.csv"), still(0.0)).expect("writable");
    fs::write(folder.path().join("tenth.csv"), still(0.1)).expect("writable");
    folder
}

/// A model of the sensor at rest, which needs nine options to be trained.
fn trained() -> TempDir {
    let folder = files();
    let mut arguments = vec!["train", "still.csv", "-o", "model.toml", "--restarts", "2", "--seed", "7"];
    arguments.extend(["--scale-factor", "420", "--hold-out", "flat-1", "--serial", "S-9"]);
    arguments.extend(AS_LOGGED);
    succeeds(folder.path(), &arguments);
    folder
}

#[test]
fn a_sensor_at_rest_keeps_its_scale_factor_when_effects_are_added_and_removed() {
    let folder = trained();
    let at = folder.path();
    succeeds(at, &["add", "model.toml", "thermal-lag", "still.csv", "-o", "added.toml"]);
    succeeds(at, &["remove", "added.toml", "thermal-lag", "still.csv", "-o", "removed.toml"]);
    for model in ["model.toml", "added.toml", "removed.toml"] {
        let reads_wrong_by_ug =
            residual_ug(at, &["compare", model, "tenth.csv", "--constant-reference", "0.1", "--json"]);
        assert!(reads_wrong_by_ug < 3000.0, "{model}: 0.1 g is read wrong by {reads_wrong_by_ug} µg");
        let text = fs::read_to_string(at.join(model)).expect("written");
        for kept in ["scale_factor_hz_per_g = 420.0", "held_out_runs = [\"flat-1\"]", "serial = \"S-9\"", "seed = 7"] {
            assert!(text.contains(kept), "{model} has lost {kept}:\n{text}");
        }
    }
    let (without, with) = (
        residual_ug(at, &["compare", "model.toml", "still.csv", "--json"]),
        residual_ug(at, &["compare", "added.toml", "still.csv", "--json"]),
    );
    assert!(with < 0.1 * without, "the lag that was added takes {without} to {with} µg");
}

#[test]
fn every_verb_reads_a_foreign_file_as_the_model_was_trained_on_it() {
    let folder = trained();
    let at = folder.path();
    // Nothing to plan is an answer too.
    for (verb, code) in [("compare", 0), ("diagnose", 0), ("plan", 1), ("verify", 0)] {
        let note = told(at, &[verb, "model.toml", "still.csv"], code);
        assert!(note.contains("Read as the model's campaign was") && note.contains("delta_f_hz=FreqDiff"), "{note}");
    }
    // The very campaign: the runs that the training saw are known as such.
    let text = succeeds(at, &["compare", "model.toml", "still.csv"]);
    assert_eq!(text.matches("held out").count(), 1, "{text}");
}

#[test]
fn an_option_overrides_what_the_model_keeps() {
    let folder = trained();
    let at = folder.path();
    let on_its_own = residual_ug(at, &["compare", "model.toml", "still.csv", "--json"]);
    let elsewhere = residual_ug(at, &["compare", "model.toml", "still.csv", "--json", "--constant-reference", "0.001"]);
    assert!((elsewhere - 1000.0).abs() < on_its_own, "{on_its_own} becomes {elsewhere} µg");
    // A table that says its reference in a column needs no constant, and one with our own names needs no mapping.
    let text =
        still(0.0).replace("FreqDiff", "delta_f_hz").replace(";operator", ";reference_g").replace(";Ann", ";0.002");
    fs::write(at.join("column.csv"), text).expect("writable");
    let elsewhere = residual_ug(at, &["compare", "model.toml", "column.csv", "--json"]);
    assert!((elsewhere - 2000.0).abs() < on_its_own, "{on_its_own} becomes {elsewhere} µg");
    succeeds(at, &["add", "model.toml", "thermal-lag", "still.csv", "-o", "added.toml", "--scale-factor", "210"]);
    let text = fs::read_to_string(at.join("added.toml")).expect("written");
    assert!(text.contains("scale_factor_hz_per_g = 210.0"), "{text}");
}

#[test]
fn a_model_of_another_quantity_is_told_apart() {
    let folder = trained();
    let units = ["--signal", "FreqDiff", "--signal-unit", "ppm"];
    let error = told(folder.path(), &[&["compare", "model.toml", "still.csv"][..], &units].concat(), 2);
    assert!(
        error.contains("the model is of a signal in Hz and a reference in g, the campaign of a signal in ppm"),
        "{error}"
    );
}

#[test]
fn a_manifest_serves_data_that_lost_it_and_gives_way_to_another_one() {
    let folder = files();
    let at = folder.path();
    let manifest = "constant_reference = 0.0\nignore = [\"operator\"]\n[columns]\nrun = \"record\"\ntime_s = \"t_ms * 0.001\"\n\
                    delta_f_hz = \"FreqDiff\"\ntemperature_c = \"T10 * 0.1\"\n";
    let place = |name: &str, manifest: &str| {
        fs::create_dir(at.join(name)).expect("a folder");
        fs::copy(at.join("still.csv"), at.join(name).join("still.csv")).expect("copied");
        fs::write(at.join(name).join("campaign.toml"), manifest).expect("writable");
    };
    place("lab", manifest);
    place("other", &manifest.replace("0.0\n", "0.003\n"));
    succeeds(at, &["train", "lab/still.csv", "-o", "model.toml", "--restarts", "2", "--scale-factor", "420"]);
    let here = residual_ug(at, &["compare", "model.toml", "lab/still.csv", "--json"]);
    assert_eq!(residual_ug(at, &["compare", "model.toml", "still.csv", "--json"]), here);
    let elsewhere = residual_ug(at, &["compare", "model.toml", "other/still.csv", "--json"]);
    assert!((elsewhere - 3000.0).abs() < here, "{here} becomes {elsewhere} µg");
    // What was said over a manifest is said over it for ever.
    succeeds(
        at,
        &[
            "train",
            "lab/still.csv",
            "-o",
            "m.toml",
            "--restarts",
            "2",
            "--scale-factor",
            "420",
            "--constant-reference",
            "1",
        ],
    );
    assert!(residual_ug(at, &["compare", "m.toml", "lab/still.csv", "--json"]) < 10_000.0);
}

#[test]
fn a_model_that_cannot_measure_is_refused_by_every_verb() {
    let folder = trained();
    let at = folder.path();
    let text = fs::read_to_string(at.join("model.toml")).expect("written");
    let line = text.lines().find(|line| line.starts_with("line_g = ")).expect("a line");
    for (name, spoilt) in [
        ("dead.toml", "line_g = [0.0, 0.0, 0.0, 0.0]"),
        ("turned.toml", "line_g = [0.0, 1.0, 0.0, -3.0]"),
        ("other.toml", "line_g = [0.0, -1.0, 0.0, 0.0]"),
    ] {
        fs::write(at.join(name), text.replace(line, spoilt)).expect("writable");
        for verb in [
            &["compare", name, "still.csv"][..],
            &["diagnose", name, "still.csv"],
            &["plan", name, "still.csv"],
            &["verify", name, "still.csv"],
            &["export", name, "-o", "out.bin"],
            &["flash", name, "--to", "tcp:127.0.0.1:9"],
            &["add", name, "thermal-lag", "still.csv", "-o", "out.toml"],
            &["remove", name, "thermal-lag", "still.csv", "-o", "out.toml"],
        ] {
            let error = told(at, verb, 2);
            assert!(error.contains(name) && error.contains("slope"), "{verb:?}: {error}");
            assert!(error.contains("help: "), "{verb:?}: {error}");
        }
    }
}

#[test]
fn a_reference_that_never_varies_needs_a_scale_factor_before_it_is_trained_on() {
    let folder = files();
    let mut arguments = vec!["train", "still.csv", "-o", "model.toml", "--restarts", "1"];
    arguments.extend(AS_LOGGED);
    let error = told(folder.path(), &arguments, 2);
    assert!(error.contains("--scale-factor"), "{error}");
    assert!(!folder.path().join("model.toml").exists());
}
