//! Claim: README's commands print what README says that they print.

use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The fenced blocks of README, without their fences.
fn blocks() -> Vec<String> {
    let text = fs::read_to_string(root().join("README.md")).expect("a README");
    text.split("```\n").skip(1).step_by(2).map(str::to_owned).collect()
}

/// A folder in which README's paths exist.
fn checkout() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    let campaigns = folder.path().join("tests/campaigns");
    fs::create_dir_all(&campaigns).expect("a folder");
    fs::copy(root().join("tests/campaigns/small.csv"), campaigns.join("small.csv")).expect("copied");
    folder
}

fn printed(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    let output = command.current_dir(folder).env("NO_COLOR", "1").args(arguments).assert().success();
    String::from_utf8(output.get_output().stdout.clone()).expect("text")
}

/// README shows the beginning of what a command prints; what follows it is told in words.
fn assert_begins(printed: &str, shown: &str, command: &str) {
    let pairs = shown.trim_end().lines().zip(printed.lines().chain(std::iter::repeat("(nothing)")));
    for (shown, printed) in pairs {
        assert_eq!(shown.trim_end(), printed.trim_end(), "`{command}` prints the second, README shows the first");
    }
}

#[test]
fn the_tour_prints_what_it_shows() {
    let folder = checkout();
    let mut compared = 0;
    for block in blocks().iter().filter(|block| block.starts_with("$ tempco ")) {
        for step in block.split("$ tempco ").skip(1) {
            let (line, shown) = step.split_once('\n').expect("a line");
            let command = line.split('#').next().unwrap_or_default().trim();
            // Lines to an instrument need one; tests/device.rs and .ci/test have them.
            if command.contains("tcp:") || command.contains("--on qemu") {
                assert!(shown.is_empty(), "nothing compares what `{command}` prints");
                continue;
            }
            let arguments: Vec<&str> = command.split(' ').collect();
            assert_begins(&printed(folder.path(), &arguments), shown, command);
            compared += shown.lines().count();
        }
    }
    assert!(compared > 20, "only {compared} lines were compared");
}

#[test]
fn the_demo_prints_what_is_shown() {
    let folder = checkout();
    let blocks = blocks();
    let shown = blocks.iter().find(|block| block.starts_with("1. Measurements")).expect("the demo's output");
    let printed = printed(folder.path(), &["demo"]);
    assert_begins(&printed, shown, "tempco demo");
    assert_eq!(printed.trim_end().lines().count(), shown.trim_end().lines().count());
}
