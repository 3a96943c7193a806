//! What the workbench does when asked, and that it is what the command line does.

use super::served::{SMALL, Served};
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::Command;
use tempfile::TempDir;

/// The reader's own words, with file and line, reach whoever dropped the file.
#[test]
fn a_bad_upload_gets_the_readers_own_error() {
    let served = Served::small();
    let rows = "time_s,temperature_c,reference_g,delta_f_hz\n0,20,0,1\n1,20,1,2\n2,warm,0,3\n";
    let state = served.dropped("bad.csv", rows);
    let (message, help) = (&state["refused"]["message"], &state["refused"]["help"]);
    let message = message.as_str().expect("a message");
    assert!(
        message.contains("bad.csv:4") && message.contains("temperature_c") && message.contains("warm"),
        "{message}"
    );
    assert!(help.as_str().is_some_and(|help| !help.is_empty()), "{help}");
    // What was there before is still there.
    assert_eq!(state["campaign"]["rows"], 2736);
    assert_eq!(served.post("load", "no JSON").status, 400);
    assert_eq!(served.post("train", r#"{"restart":1}"#).status, 400);
    assert_eq!(served.post("diagnose", r#"{"model":1}"#).status, 409);
}

#[test]
fn an_upload_with_other_names_is_read_as_it_is_told() {
    let served = Served::small();
    let text = fs::read_to_string(SMALL).expect("checked in").replacen("delta_f_hz", "FreqDiff", 1);
    let upload = served.uploads();
    assert_eq!(served.upload(upload, "other%20names.csv", &text).status, 204);
    let state = served.done("load", r#"{"upload":1,"files":["other names.csv"],"map":["delta_f_hz=FreqDiff"]}"#);
    assert_eq!((&state["refused"], &state["campaign"]["rows"]), (&serde_json::Value::Null, &2736.into()));
    let command = state["campaign"]["command"].as_str().expect("a command");
    assert!(command.ends_with("'tempco-workbench/upload-1/other names.csv' --map delta_f_hz=FreqDiff"), "{command}");
}

#[test]
fn stopped_work_leaves_nothing_behind_and_only_one_piece_goes_on_at_a_time() {
    let served = Served::small();
    assert_eq!(served.post("train", r#"{"restarts":10000}"#).status, 204);
    assert_eq!(served.post("train", "{}").status, 409);
    assert_eq!(served.state()["job"]["step"], "train");
    assert_eq!(served.post("stop", "{}").status, 204);
    let state = served.settled();
    assert_eq!((&state["stopped"], &state["refused"]), (&"train".into(), &serde_json::Value::Null));
    assert_eq!(state["models"].as_array().map(Vec::len), Some(0));
    assert!(!served.path("model-1.toml").exists());
}

/// Each command that the page shows is carried out in another folder, and gives the same bytes.
#[test]
fn the_commands_that_are_shown_do_the_same() {
    let served = Served::small();
    served.done("split", r#"{"hold_out":["full-2","zero-1"]}"#);
    served.done("train", r#"{"restarts":3,"seed":7}"#);
    served.done("add", r#"{"model":1,"effect":"second-order"}"#);
    served.done("remove", r#"{"model":2,"effect":"second-order"}"#);
    served.done("export", r#"{"model":2}"#);
    let state = served.done("verify", r#"{"model":2}"#);
    let models = state["models"].as_array().expect("models");
    assert_eq!(models.len(), 3);
    assert_eq!((&models[1]["parity"]["samples"], &models[1]["parity"]["identical"]), (&2736.into(), &2736.into()));
    let folder = TempDir::new().expect("a folder");
    fs::create_dir(folder.path().join("tempco-workbench")).expect("a folder");
    let made_by = models.iter().map(|model| &model["commands"]["made_by"]);
    for command in made_by.chain([&models[1]["commands"]["export"], &models[1]["commands"]["verify"]]) {
        let line = command.as_str().expect("a command").replace("tempco ", "\"$TEMPCO\" ");
        let mut shell = Command::new("sh");
        shell.env("TEMPCO", env!("CARGO_BIN_EXE_tempco")).arg("-c").arg(&line).current_dir(folder.path());
        assert!(shell.output().expect("a shell").status.success(), "{line}");
    }
    for file in ["model-1.toml", "model-2.toml", "model-3.toml", "calibration-2.hex", "calibration-2.bin"] {
        let there = fs::read(folder.path().join("tempco-workbench").join(file)).expect("written");
        assert!(there == fs::read(served.path(file)).expect("written"), "{file}");
    }
    let hex = served.get("/api/download?model=2&format=hex");
    assert!(hex.head.contains("attachment; filename=\"calibration-2.hex\""), "{}", hex.head);
    assert!(hex.body == fs::read(served.path("calibration-2.hex")).expect("written"));
    assert_eq!(models[2]["effects"].as_array().map(Vec::len), Some(0));
    assert_eq!(models[0]["comparison"]["residual_ug"], models[2]["comparison"]["residual_ug"]);
}

#[test]
fn every_restart_is_told_as_it_goes_and_the_end_as_a_new_state() {
    let served = Served::small();
    let own = format!("Host: 127.0.0.1:{}\r\n{}", served.port, served.token_header());
    let mut lines = BufReader::new(served.begin("GET", "/api/events", &own, b"")).lines();
    served.done("train", r#"{"restarts":3}"#);
    let mut curves = std::collections::BTreeSet::new();
    let mut noise_ug = 0.0;
    for line in lines.by_ref().map(|line| line.expect("text")) {
        let Some(data) = line.strip_prefix("data: ").or_else(|| line.strip_prefix("data:")) else { continue };
        let data: serde_json::Value = serde_json::from_str(data).expect("JSON");
        for report in data["reports"].as_array().into_iter().flatten() {
            match report["kind"].as_str() {
                Some("begins") => assert_eq!(report["restarts"], 3),
                Some("restart") => {
                    let residual_ug = report["residual_ug"].as_f64().expect("a number");
                    noise_ug = report["noise_ug"].as_f64().expect("a number");
                    assert!(residual_ug > 0.9 * noise_ug, "{residual_ug} µg, noise {noise_ug} µg");
                    curves.insert(report["curve"].as_u64());
                }
                other => panic!("{other:?}"),
            }
        }
        if curves.len() >= 3 && data.is_u64() {
            break;
        }
    }
    assert!(noise_ug > 0.3 && curves.len() >= 3, "{noise_ug} {curves:?}");
}

#[test]
fn samples_and_a_choice_among_them_are_those_of_the_campaign() {
    let served = Served::small();
    served.done("train", r#"{"restarts":2}"#);
    let body = served.get("/api/samples?models=1").body;
    let length = u32::from_le_bytes(body[..4].try_into().expect("four bytes")) as usize;
    let head: serde_json::Value = serde_json::from_slice(&body[4..4 + length]).expect("JSON");
    assert_eq!((&head["rows"], &head["kept"]), (&2736.into(), &2736.into()));
    let columns = head["columns"].as_array().expect("names").len() + 1;
    assert_eq!(body.len(), 4 + length + 4 * 2736 * columns);
    let all = served.post("chosen", r#"{"models":[1],"ranges":[]}"#).json();
    assert_eq!((&all["samples"], &all["of"]), (&2736.into(), &2736.into()));
    let cold = r#"{"models":[1],"held_out":true,"ranges":[{"column":"temperature_c","low":null,"high":0}]}"#;
    let cold = served.post("chosen", cold).json();
    let held_out = served.state()["models"][0]["comparison"]["residual_ug"].as_f64().expect("a number");
    let judged = served.post("chosen", r#"{"models":[1],"held_out":true,"ranges":[]}"#).json();
    let same = judged["models"][0]["rms_ug"].as_f64().expect("a number");
    assert!((same / held_out - 1.0).abs() < 1e-5, "{same} {held_out}");
    assert!(cold["samples"].as_u64() < judged["samples"].as_u64() && cold["samples"].as_u64() > Some(0), "{cold}");
    assert_eq!(served.get("/api/samples?models=9").status, 409);
}

#[test]
fn a_file_that_is_not_there_is_said_in_the_terminal() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_tempco")).args(["workbench", "no-such.csv"]).output().expect("it runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("no-such.csv") && said.contains("help:"), "{said}");
}
