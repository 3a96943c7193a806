//! Claim: the crates depend on each other as the architecture says, and on nothing they must not see.

use std::collections::BTreeSet;
use tests::workspace::{sources, text};
use toml::Table;

/// Each crate and the crates of this workspace that it may depend on.
const MAY_DEPEND_ON: [(&str, &[&str]); 8] = [
    ("protocol", &[]),
    ("firmware-core", &["protocol"]),
    ("firmware", &["firmware-core", "protocol"]),
    ("firmware-sim", &["firmware-core", "protocol"]),
    ("trainer", &["firmware-core", "protocol"]),
    ("tempco", &["firmware-core", "firmware-sim", "protocol", "trainer"]),
    ("tests", &["cores", "firmware-core", "firmware-sim", "protocol", "tempco", "trainer"]),
    ("tests/cores", &["firmware-core", "protocol"]),
];

fn manifest(folder: &str) -> Table {
    text(format!("{folder}/Cargo.toml")).parse().expect("a manifest is TOML")
}

/// The crates of this workspace that a manifest names in any of its dependency tables.
fn internal_dependencies(folder: &str) -> BTreeSet<String> {
    let manifest = manifest(folder);
    let targets = manifest.get("target").and_then(toml::Value::as_table).into_iter().flatten();
    let tables = targets.filter_map(|(_, target)| target.as_table()).chain([&manifest]);
    tables
        .flat_map(|table| ["dependencies", "dev-dependencies", "build-dependencies"].map(|kind| table.get(kind)))
        .flatten()
        .filter_map(toml::Value::as_table)
        .flat_map(|dependencies| dependencies.keys().cloned())
        .filter(|name| MAY_DEPEND_ON.iter().any(|(folder, _)| folder.rsplit('/').next() == Some(name)))
        .collect()
}

/// The files below `folder` whose code, comments and tests aside, contains one of `words`.
fn files_with(folder: &str, words: &[&str]) -> Vec<String> {
    let mut offenders = Vec::new();
    for file in sources(folder) {
        let source = text(&file);
        // Tests stand at the foot of a file, and run on the host.
        let code = source.lines().take_while(|line| *line != "mod tests {");
        let code = code.filter(|line| !line.trim_start().starts_with("//"));
        for (number, line) in code.enumerate() {
            if words.iter().any(|word| line.contains(word)) {
                offenders.push(format!("{}, code line {}: {}", file.display(), number + 1, line.trim()));
            }
        }
    }
    offenders
}

#[test]
fn only_the_drawn_arrows_exist() {
    for (folder, allowed) in MAY_DEPEND_ON {
        for dependency in internal_dependencies(folder) {
            assert!(allowed.contains(&dependency.as_str()), "{folder} must not depend on {dependency}");
        }
    }
}

#[test]
fn the_table_of_arrows_names_every_member_of_the_workspace() {
    let workspace = manifest(".");
    let members = workspace["workspace"]["members"].as_array().expect("a list of members");
    let members: BTreeSet<_> = members.iter().filter_map(toml::Value::as_str).collect();
    assert_eq!(members, MAY_DEPEND_ON.iter().map(|(member, _)| *member).collect());
}

#[test]
fn plain_cargo_builds_everything_but_the_image() {
    let workspace = manifest(".");
    let default = workspace["workspace"]["default-members"].as_array().expect("a list of default members");
    assert!(default.iter().all(|member| member.as_str() != Some("firmware")));
    assert_eq!(default.len() + 1, MAY_DEPEND_ON.len());
}

#[test]
fn the_twin_knows_neither_the_protocol_nor_the_instrument() {
    for folder in ["twin", "scenario", "simulation", "recording", "blind", "limit"] {
        let folder = format!("firmware-sim/src/{folder}");
        assert!(!sources(&folder).is_empty(), "{folder}");
        let offenders = files_with(&folder, &["protocol", "firmware_core", "virtual_", "crate::link"]);
        assert!(offenders.is_empty(), "{offenders:#?}");
    }
}

#[test]
fn what_runs_on_the_device_is_written_without_std_alloc_unsafe_and_panics() {
    for folder in ["protocol/src", "firmware-core/src"] {
        assert!(text(format!("{folder}/lib.rs")).contains("#![no_std]"), "{folder}");
        let words = ["std::", "extern crate", "unsafe ", "panic!", "todo!", "unimplemented!", "unreachable!"];
        let mut offenders = files_with(folder, &words);
        // The manual's examples run on the host, too.
        offenders.retain(|offender| !offender.contains("assert"));
        assert!(offenders.is_empty(), "{offenders:#?}");
    }
}

#[test]
fn unsafe_code_is_forbidden_everywhere_but_on_the_board() {
    for (folder, _) in MAY_DEPEND_ON {
        let manifest = manifest(folder);
        let inherits = manifest["lints"].get("workspace").and_then(toml::Value::as_bool) == Some(true);
        assert!(inherits || folder == "firmware", "{folder} must inherit the workspace's lints");
    }
    let offenders = files_with("firmware/src", &["unsafe"]);
    assert!(
        offenders.iter().all(|offender| ["board.rs", "registers.rs"].iter().any(|file| offender.contains(file))),
        "{offenders:#?}"
    );
}
