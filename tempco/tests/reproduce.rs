//! Blind campaigns and their envelopes, and the reproduction of the paper, as a user meets them.

use assert_cmd::Command;
use firmware_sim::twin::effect::Effects;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.toml");

fn tempco(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    command.current_dir(folder).env("NO_COLOR", "1");
    command
}

fn stdout(folder: &Path, arguments: &[&str]) -> String {
    let output = tempco(folder).args(arguments).assert().success().get_output().stdout.clone();
    String::from_utf8(output).expect("text")
}

fn stderr(folder: &Path, arguments: &[&str]) -> String {
    let output = tempco(folder).args(arguments).assert().code(2).get_output().stderr.clone();
    String::from_utf8(output).expect("text")
}

/// A folder with `campaign.csv` and `campaign.sealed`, and what the command said.
fn blind(seed: &str, options: &[&str]) -> (TempDir, String) {
    let folder = TempDir::new().expect("a folder");
    let mut arguments = vec!["simulate", SCENARIO, "--blind", "--seed", seed, "-o", "campaign.csv"];
    arguments.extend(options);
    let said = stdout(folder.path(), &arguments);
    (folder, said)
}

fn revealed(folder: &TempDir) -> Value {
    let text = stdout(folder.path(), &["reveal", "campaign.sealed", "--json"]);
    serde_json::from_str(&text).expect("JSON")
}

fn names_an_effect(text: &str) -> bool {
    Effects::NAMES.iter().any(|name| text.contains(name))
}

#[test]
fn what_a_blind_campaign_hides_is_told_by_its_envelope_only() {
    let (folder, said) = blind("3", &[]);
    assert!(said.contains("campaign.sealed") && !names_an_effect(&said), "{said}");
    for file in ["campaign.csv", "campaign.sealed"] {
        let text = fs::read_to_string(folder.path().join(file)).expect("written");
        assert!(!names_an_effect(&text), "{file}");
    }
    let text = stdout(folder.path(), &["reveal", "campaign.sealed"]);
    assert!(text.contains("share µg") && names_an_effect(&text), "{text}");
    let truth = revealed(&folder);
    let hidden = truth["hidden"].as_array().expect("a list");
    assert!((1..=2).contains(&hidden.len()), "{truth}");
    for effect in hidden {
        assert!(names_an_effect(effect["effect"].as_str().expect("a name")), "{truth}");
        assert!(effect["share_ug"].as_f64().is_some_and(|share_ug| share_ug > 0.0), "{truth}");
        assert!(effect["parameters"].as_object().is_some_and(|parameters| !parameters.is_empty()), "{truth}");
    }
}

#[test]
fn the_same_seed_gives_the_same_campaign_and_envelope_byte_for_byte() {
    let bytes = |folder: &TempDir| {
        ["campaign.csv", "campaign.sealed"].map(|file| fs::read(folder.path().join(file)).expect("written"))
    };
    let [(a, _), (b, _), (c, _)] = ["5", "5", "6"].map(|seed| blind(seed, &[]));
    assert!(bytes(&a) == bytes(&b));
    assert!(bytes(&a)[0] != bytes(&c)[0] && bytes(&a)[1] != bytes(&c)[1]);
}

#[test]
fn what_may_be_hidden_can_be_narrowed() {
    let (outside, _) = blind("1", &["--outside"]);
    let truth = revealed(&outside);
    assert!(truth["hidden"][0]["effect"].as_str().is_some_and(|name| name.starts_with("x-")), "{truth}");
    let counts = ["7", "8"].map(|seed| {
        let (folder, _) = blind(seed, &["--nothing-possible", "--effects-at-most", "1"]);
        revealed(&folder)["hidden"].as_array().expect("a list").len()
    });
    assert_eq!(counts, [0, 1]);
}

#[test]
fn an_envelope_that_was_touched_or_belongs_elsewhere_is_refused_with_a_way_out() {
    let (folder, _) = blind("3", &[]);
    let (other, _) = blind("4", &[]);
    let path = |file: &str| folder.path().join(file);
    fs::copy(other.path().join("campaign.csv"), path("other.csv")).expect("copied");
    let sealed = fs::read_to_string(path("campaign.sealed")).expect("written");
    let last = sealed.trim_end().chars().last().expect("not empty");
    let touched =
        format!("{}{}\n", &sealed.trim_end()[..sealed.trim_end().len() - 1], if last == '0' { '1' } else { '0' });
    fs::write(path("touched.sealed"), touched).expect("written");
    let table: [(&[&str], &str); 5] = [
        (&["reveal", "touched.sealed", "campaign.csv"], "was changed after it was sealed"),
        (&["reveal", "campaign.sealed", "other.csv"], "other.csv is another campaign, or was changed since"),
        (&["reveal", "touched.sealed"], "tempco reveal touched.sealed CAMPAIGN"),
        (&["reveal", "campaign.csv", "campaign.csv"], "not a sealed truth"),
        (&["simulate", SCENARIO, "--blind", "-o", "campaign.sealed"], "-o campaign.csv"),
    ];
    for (arguments, expected) in table {
        let text = stderr(folder.path(), arguments);
        assert!(
            text.starts_with("error:") && text.contains("help:") && text.contains(expected),
            "{arguments:?}: {text}"
        );
    }
}

/// One small reproduction for all that is asked of it.
const FEW: [&str; 9] = ["reproduce", "--seeds", "5", "--restarts", "1", "--passes", "20", "-o", "out"];

#[test]
fn the_reproduction_draws_its_figures_and_prints_the_papers_numbers() {
    let folder = TempDir::new().expect("a folder");
    let text = stdout(folder.path(), &FEW);
    for words in ["FA as printed", "the IFA finally converges", "186.5", "20600", "214.9", "perfect map", "seed-a2"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    for file in ["figure-3-schaffer.svg", "figure-4-rastrigin.svg", "success-rates.svg", "between-the-levels.svg"] {
        let svg = fs::read_to_string(folder.path().join("out").join(file)).expect("written");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.len() > 5000, "{file}");
    }
    for campaign in ["seed.csv", "seed-a1.csv", "seed-a2.csv"] {
        assert!(folder.path().join("out").join(campaign).exists(), "{campaign}");
    }
}

#[test]
fn other_programs_read_the_reproduction_and_get_the_same_twice() {
    let folder = TempDir::new().expect("a folder");
    let run = |threads: &str| {
        let mut command = tempco(folder.path());
        command.args(FEW).args(["--figures", "--json"]).env("RAYON_NUM_THREADS", threads);
        command.assert().success().get_output().stdout.clone()
    };
    let first = run("1");
    assert!(first == run("3"));
    let value: Value = serde_json::from_slice(&first).expect("JSON");
    assert_eq!(value["rates"].as_array().map(Vec::len), Some(48));
    assert_eq!(value["claims"][0]["outcomes"].as_array().map(Vec::len), Some(4));
    assert!(value["campaigns"].as_array().is_some_and(Vec::is_empty));
}

#[test]
fn help_of_the_verbs_has_an_example() {
    let folder = TempDir::new().expect("a folder");
    for verb in ["reveal", "reproduce"] {
        let text = stdout(folder.path(), &[verb, "--help"]);
        assert!(text.contains(&format!("Example:  tempco {verb}")), "{verb}: {text}");
    }
}
