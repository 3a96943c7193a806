//! What `add` and `remove` make of a model, and what they say of an effect that does not help.

use super::{SMALL, stderr_of, stdout, tempco, with_supply};
use std::fs;
use tempfile::TempDir;

#[test]
fn an_effect_that_does_not_help_is_doubted_and_the_way_back_is_told() {
    let folder = TempDir::new().expect("a folder");
    let run = |arguments: &[&str]| {
        let output = tempco(folder.path()).args(arguments).output().expect("tempco runs");
        (output.status.code(), String::from_utf8(output.stdout).expect("text"))
    };
    fs::copy(SMALL, folder.path().join("small.csv")).expect("copied");
    run(&["train", "small.csv", "-o", "model.toml", "--restarts", "2"]);
    let before = fs::read(folder.path().join("model.toml")).expect("trained");
    let (code, text) = run(&["add", "model.toml", "thermal-gradient", "small.csv", "-o", "with.toml"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("\nDoubtful: with thermal-gradient the held-out residual does not fall"), "{text}");
    assert!(text.contains("\nNext:  go back to model.toml, which is as it was"), "{text}");
    assert_eq!(fs::read(folder.path().join("model.toml")).expect("still there"), before);
    let (code, text) = run(&["add", "model.toml", "thermal-gradient", "small.csv", "-o", "with.toml", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert!(code == Some(1) && value["doubts"].as_array().is_some_and(|doubts| !doubts.is_empty()), "{value}");
    // To take it out again is no doubt.
    assert_eq!(run(&["remove", "with.toml", "thermal-gradient", "small.csv", "-o", "without.toml"]).0, Some(0));
}

#[test]
fn an_effect_of_ones_own_is_added_shown_verified_and_removed() {
    const TEXT: &str = "(supply_v - 5) * level_g";
    let folder = TempDir::new().expect("a folder");
    with_supply(folder.path());
    let run = |arguments: &[&str]| stdout(tempco(folder.path()).args(arguments));
    run(&["train", "supply.csv", "-o", "model.toml", "--restarts", "4"]);
    let text = run(&["add", "model.toml", "--expression", TEXT, "supply.csv", "-o", "better.toml", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let residual_ug = |rung: usize| value["ladder"][rung]["residual_ug"].as_f64().expect("a residual");
    assert!(value["ladder"][1]["effect"] == TEXT && residual_ug(1) < 0.1 * residual_ug(0), "{value:#}");
    let amplitude_g = value["effects"][0]["parameters"]["amplitude_g"].as_f64().expect("an amplitude");
    assert!((amplitude_g - 1e-3).abs() < 2e-5, "{value:#}");
    assert!(run(&["verify", "better.toml", "supply.csv"]).contains("identical in every bit"));
    run(&["export", "better.toml", "-o", "calibration.bin"]);
    let text = run(&["inspect", "calibration.bin"]);
    assert!(text.contains(TEXT) && text.contains("A device would take it."), "{text}");
    let failed = |arguments: &[&str]| stderr_of(tempco(folder.path()).args(arguments), 2);
    let add = |text: &str| failed(&["add", "better.toml", "--expression", text, "supply.csv", "-o", "no.toml"]);
    assert!(add("(supply_v-5)*level_g").contains("already"));
    let text = add("supply_v * temprature_rate");
    assert!(text.contains("column 12") && text.contains("did you mean `temperature_rate`?"), "{text}");
    assert!(failed(&["add", "model.toml", "supply.csv", "-o", "no.toml"]).contains("one of them is missing"));
    let text = failed(&["remove", "better.toml", "thermal-lag", "supply.csv", "-o", "no.toml"]);
    assert!(text.contains(TEXT), "{text}");
    let text = run(&["remove", "better.toml", "--expression", "(supply_v-5)*level_g", "supply.csv", "-o", "bare.toml"]);
    assert!(text.contains("Model written to bare.toml"), "{text}");
    assert!(!fs::read_to_string(folder.path().join("bare.toml")).expect("written").contains("[[effect]]"));
}
