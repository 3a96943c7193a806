//! Nothing that was made is lost: not by another campaign, not by another day, not by another workbench.

use super::served::{SMALL, Served};
use serde_json::{Value, json};
use std::fs;
use std::process::Command;
use tempfile::TempDir;

const QUICK: &str = r#"{"restarts":1}"#;

fn small() -> String {
    fs::read_to_string(SMALL).expect("checked in")
}

fn numbers(state: &Value) -> Vec<u64> {
    state["models"].as_array().expect("models").iter().filter_map(|model| model["number"].as_u64()).collect()
}

#[test]
fn another_campaign_leaves_models_and_calibrations_of_the_first_and_one_can_go_back() {
    let served = Served::small();
    served.done("train", QUICK);
    served.done("export", r#"{"model":1}"#);
    let files = ["model-1.toml", "calibration-1.hex", "calibration-1.bin"];
    let before = files.map(|file| fs::read(served.path(file)).expect("written"));
    let state = served.dropped("second.csv", &small());
    assert_eq!((numbers(&state), &state["current"]), (vec![], &Value::Null));
    assert_eq!(state["campaigns"][0]["models"], json!([1]), "the page can tell what is set aside");
    let state = served.done("train", r#"{"restarts":1,"seed":5}"#);
    assert_eq!(numbers(&state), [2], "a number is given once in a session");
    served.done("export", r#"{"model":2}"#);
    assert_eq!(files.map(|file| fs::read(served.path(file)).expect("written")), before);
    for model in [1, 2] {
        let file = format!("model-{model}.toml");
        assert!(served.path(&file).exists() && served.path(&format!("calibration-{model}.hex")).exists());
    }
    let state = served.done("campaign", r#"{"campaign":1}"#);
    assert_eq!((numbers(&state), &state["current"]), (vec![1], &json!(1)));
    assert!(!state["models"][0]["exported"].is_null());
    assert!(state["campaign"]["files"][0].as_str().expect("a file").ends_with("small.csv"));
    served.done("diagnose", r#"{"model":1}"#);
    assert_eq!(served.post("campaign", r#"{"campaign":7}"#).status, 409);
    let state = served.done("demo", "{}");
    assert_eq!(state["campaigns"].as_array().map(Vec::len), Some(3));
}

#[test]
fn what_lies_in_the_folder_already_keeps_its_name_and_its_bytes() {
    let folder = TempDir::new().expect("a folder");
    let own = folder.path().join("tempco-workbench");
    fs::create_dir(&own).expect("a folder");
    let files = ["model-1.toml", "calibration-2.hex", "campaign.csv", "campaign.sealed"];
    for file in files {
        fs::write(own.join(file), "of another day").expect("written");
    }
    let served = Served::start_in(folder, &["--demo"]);
    served.settled();
    let state = served.done("train", QUICK);
    assert_eq!(numbers(&state), [3], "1 and 2 are taken by files of another day");
    assert_eq!(state["models"][0]["file"], "tempco-workbench/model-3.toml");
    let command = state["models"][0]["commands"]["made_by"].as_str().expect("a command");
    assert!(command.ends_with("-o tempco-workbench/model-3.toml"), "{command}");
    fs::write(served.path("calibration-3.hex"), "put there since").expect("written");
    let refused = served.post("export", r#"{"model":3}"#);
    assert_eq!(refused.status, 422);
    assert!(String::from_utf8_lossy(&refused.body).contains("calibration-3.hex"));
    assert_eq!(fs::read(served.path("calibration-3.hex")).expect("there"), b"put there since");
    fs::remove_file(served.path("calibration-3.hex")).expect("there");
    served.done("export", r#"{"model":3}"#);
    served.done("export", r#"{"model":3}"#);
    fs::write(served.path("calibration-3.bin"), "edited").expect("written");
    assert_eq!(served.post("export", r#"{"model":3}"#).status, 422);
    assert_eq!(fs::read(served.path("calibration-3.bin")).expect("there"), b"edited");
    for file in files {
        assert_eq!(fs::read(served.path(file)).expect("there"), b"of another day", "{file}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_under_a_models_name_is_not_followed() {
    let folder = TempDir::new().expect("a folder");
    let own = folder.path().join("tempco-workbench");
    fs::create_dir(&own).expect("a folder");
    let precious = folder.path().join("precious");
    std::os::unix::fs::symlink(&precious, own.join("model-1.toml")).expect("a link to nowhere");
    let served = Served::start_in(folder, &[SMALL]);
    served.settled();
    assert_eq!(numbers(&served.done("train", QUICK)), [2]);
    assert!(!precious.exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_second_workbench_gets_another_folder() {
    let served = Served::small();
    let mut second = Command::new(env!("CARGO_BIN_EXE_tempco"));
    second.args(["workbench", SMALL]).current_dir(served.folder.path()).env("NO_COLOR", "1");
    let output = second.output().expect("it runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("another workbench") && said.contains("--output"), "{said}");
}
