//! The command lines that are offered for copying, carried out by a real shell: each argument arrives byte for byte.

use super::served::{SMALL, Served};
use serde_json::{Value, json};
use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::os::unix::fs::PermissionsExt;
use std::process::Command;
use tempfile::TempDir;

/// Names that try to end a word, to run something, to be an option, to hide.
const NAMES: [&[u8]; 9] = [
    b"x'; touch PWNED; '.csv",
    b"$(touch PWNED)`touch PWNED`.csv",
    b"\" && touch PWNED #.csv",
    b"-x.csv",
    b"--output=a b.csv",
    b"a\nb\n.csv",
    b"esc\x1b]0;title\x07.csv",
    b"rtl\xe2\x80\xaevsc.csv",
    b"latin\xe91\\ !$HOME ~ *.csv",
];

/// What a stub of this name in the path is called with, word by word.
fn handed(line: &Value) -> Vec<OsString> {
    let folder = TempDir::new().expect("a folder");
    let stub = folder.path().join("tempco");
    fs::write(&stub, "#!/bin/sh\nfor word; do printf '%s\\0' \"$word\"; done >>\"$RECORD\"\n").expect("written");
    fs::set_permissions(&stub, fs::Permissions::from_mode(0o755)).expect("a program");
    let record = folder.path().join("record");
    let path = format!("{}:/usr/bin:/bin", folder.path().display());
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(line.as_str().expect("a line")).env("PATH", path).env("RECORD", &record);
    let output = shell.current_dir(folder.path()).output().expect("a shell");
    assert!(output.status.success() && output.stderr.is_empty(), "{line}: {output:?}");
    assert!(!folder.path().join("PWNED").exists(), "{line} ran something else");
    let bytes = fs::read(record).expect("recorded");
    let words = bytes.strip_suffix(b"\0").expect("words").split(|byte| *byte == 0);
    words.map(|word| OsString::from_vec(word.to_vec())).collect()
}

#[test]
fn hostile_file_names_and_maps_arrive_as_they_are() {
    let folder = TempDir::new().expect("a folder");
    let small = fs::read_to_string(SMALL).expect("checked in");
    let (head, rows) = small.split_once('\n').expect("a header");
    let column = "it's; touch PWNED; $(touch PWNED)";
    let head = head.replacen("delta_f_hz", &format!("\"{column}\""), 1);
    let map = format!("delta_f_hz={column}");
    let mut given: Vec<OsString> = Vec::new();
    for (index, name) in NAMES.iter().enumerate() {
        let name = OsStr::from_bytes(name);
        let rows: Vec<String> = rows.lines().map(|row| row.replacen(',', &format!("-{index},"), 1)).collect();
        fs::write(folder.path().join(name), format!("{head}\n{}\n", rows.join("\n"))).expect("written");
        given.push(name.to_owned());
    }
    let mut arguments: Vec<OsString> = vec!["--map".into(), map.clone().into(), "--".into()];
    arguments.extend(given.iter().cloned());
    let served = Served::start_in(folder, &arguments);
    let state = served.settled();
    assert_eq!(state["refused"], json!(null));
    let typed = given.iter().map(|name| match name.as_bytes().starts_with(b"-") {
        true => OsString::from_vec([b"./", name.as_bytes()].concat()),
        false => name.clone(),
    });
    let expected: Vec<OsString> =
        [OsString::from("inspect")].into_iter().chain(typed).chain(["--map".into(), map.into()]).collect();
    assert_eq!(handed(&state["campaign"]["command"]), expected);
}

#[test]
fn hostile_runs_serials_and_expressions_arrive_as_they_are() {
    let folder = TempDir::new().expect("a folder");
    let run = "-r'; touch PWNED; '\u{1b}[31m\u{202e}";
    let small = fs::read_to_string(SMALL).expect("checked in").replace("full-2,", &format!("\"{run}\","));
    fs::write(folder.path().join("runs.csv"), small).expect("written");
    let served = Served::start_in(folder, &["runs.csv"]);
    assert_eq!(served.settled()["refused"], json!(null));
    served.done("split", &json!({ "hold_out": [run] }).to_string());
    let serial = "-$(touch PWNED)'\"";
    let state = served.done("train", &json!({ "restarts": 1, "serial": serial }).to_string());
    assert_eq!(state["refused"], json!(null));
    let words = handed(&state["models"][0]["commands"]["made_by"]);
    let expected: [OsString; 8] = [
        "train".into(),
        "runs.csv".into(),
        format!("--hold-out={run}").into(),
        "--restarts".into(),
        "1".into(),
        format!("--serial={serial}").into(),
        "-o".into(),
        "tempco-workbench/model-1.toml".into(),
    ];
    assert_eq!(words, expected);
    // Quotes are no part of the language; what it has, a shell would take for something else.
    let expression = "-temperature_rate * (1 + temperature_rate)";
    let state = served.done("add", &json!({ "model": 1, "expression": expression }).to_string());
    assert_eq!(state["refused"], json!(null));
    let words = handed(&state["models"][1]["commands"]["made_by"]);
    assert_eq!(words[2], OsString::from(format!("--expression={expression}")));
}
