//! Claim: nobody loses a measurement. What a command writes appears whole or not at all, and never over what its user made.

#[path = "writing/folder.rs"]
mod folder;
#[path = "writing/killed.rs"]
mod killed;

use folder::{SMALL, TEMPCO, WRITERS, contents, said, worked_in, writing};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::ExitStatus;
use tempfile::TempDir;

#[test]
fn no_command_writes_over_a_file_of_its_user_s_or_of_another_kind() {
    let folder = worked_in();
    let folder = folder.path();
    fs::write(folder.join("notes.txt"), "three days of measurements").expect("written");
    fs::hard_link(folder.join("small.csv"), folder.join("hard.csv")).expect("a link");
    std::os::unix::fs::symlink("small.csv", folder.join("soft.csv")).expect("a link");
    let before = contents(folder);
    for writer in WRITERS {
        for file in ["small.csv", "hard.csv", "soft.csv", "notes.txt", "factory.key"] {
            let text = said(folder, 2, &writing(writer, file));
            assert!(text.starts_with(&format!("error: {file}: ")) && text.contains("help: "), "{writer:?}: {text}");
            assert!(text.contains(" -o ") || text.contains("--report "), "{writer:?}: {text}");
        }
    }
    for (writer, file) in [
        (0, "calibration.bin"),
        (0, "campaign.csv"),
        (3, "model.toml"),
        (5, "model.toml"),
        (6, "report.html"),
        (3, "identity.hex"),
        (8, "calibration.hex"),
    ] {
        let text = said(folder, 2, &writing(WRITERS[writer], file));
        assert!(text.contains("would take its place"), "{text}");
    }
    assert!(contents(folder) == before, "a refused command wrote something");
}

#[test]
fn what_the_help_of_a_refusal_says_works() {
    let folder = worked_in();
    let folder = folder.path();
    fs::write(folder.join("notes.toml"), "mine").expect("written");
    let text = said(folder, 2, &["train", "small.csv", "-o", "notes.toml", "--restarts", "1"]);
    let (_, name) = text.split_once("choose another name: -o ").expect("a way out");
    let name = name.split([',', '\n']).next().expect("a name");
    said(folder, 0, &["train", "small.csv", "-o", name, "--restarts", "1"]);
    said(folder, 0, &["train", "small.csv", "-o", "notes.toml", "--restarts", "1", "--force"]);
    assert!(fs::read(folder.join(name)).expect("written") == fs::read(folder.join("notes.toml")).expect("written"));
    let text = said(folder, 2, &["train", "small.csv", "-o", "small.csv", "--restarts", "1", "--force"]);
    assert!(text.contains("this command reads it") && !text.contains("--force"), "{text}");
}

#[test]
fn what_tempco_wrote_it_writes_again() {
    let folder = worked_in();
    let folder = folder.path();
    for (writer, file) in [
        (0, "model.toml"),
        (3, "calibration.bin"),
        (3, "calibration.hex"),
        (4, "calibration.bin"),
        (5, "report.html"),
        (7, "campaign.csv"),
        (8, "identity.hex"),
    ] {
        said(folder, 0, &writing(WRITERS[writer], file));
    }
    // A table that was worked on is its user's.
    let mut table = fs::read_to_string(folder.join("campaign.csv")).expect("written");
    table += "tumble-9,tumble,1,20,76,0,76\n";
    fs::write(folder.join("campaign.csv"), table).expect("written");
    assert!(said(folder, 2, &writing(WRITERS[7], "campaign.csv")).contains("changed since"));
}

#[test]
fn the_demo_leaves_a_users_campaign_alone() {
    let folder = TempDir::new().expect("a folder");
    fs::copy(SMALL, folder.path().join("campaign.csv")).expect("copied");
    let before = contents(folder.path());
    let text = said(folder.path(), 2, &["demo", "--output", "."]);
    assert!(text.contains("campaign.csv: it is not written by tempco") && text.contains("--output FOLDER"), "{text}");
    assert!(contents(folder.path()) == before);
}

#[test]
fn what_can_be_known_before_the_work_is_said_before_it() {
    let folder = worked_in();
    let folder = folder.path();
    let before = contents(folder);
    let long = "a".repeat(25);
    for (more, expected) in [
        (["--restarts", "1000000000"], "1..=10000"),
        (["--restarts", "0"], "1..=10000"),
        (["--seed", "18446744073709551615"], "9223372036854775807"),
        (["--serial", long.as_str()], "24 bytes"),
        (["-o", "nowhere/model.toml"], "its folder is not there"),
        (["-o", "."], "this is a folder"),
    ] {
        let place: &[&str] = if more[0] == "-o" { &[] } else { &["-o", "model.toml"] };
        // Were it trained first, this would take minutes.
        let mut arguments = vec!["train", "small.csv"];
        if more[0] != "--restarts" {
            arguments.extend(["--restarts", "10000"]);
        }
        arguments.extend(place);
        arguments.extend(more);
        let text = said(folder, 2, &arguments);
        assert!(text.contains(expected), "{more:?}: {text}");
    }
    assert!(contents(folder) == before);
}

/// Runs a command under a limit on the size of files, as on a disk that is full.
fn on_a_full_disk(folder: &Path, arguments: &[&str]) -> (ExitStatus, String) {
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\"", TEMPCO]).args(arguments);
    let output = shell.current_dir(folder).env("NO_COLOR", "1").output().expect("a shell");
    (output.status, String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_full_disk_leaves_the_old_file_and_nothing_else() {
    let folder = worked_in();
    let folder = folder.path();
    let before = contents(folder);
    for (writer, file) in [
        (0, "model.toml"),
        (3, "calibration.bin"),
        (3, "calibration.hex"),
        (5, "report.html"),
        (7, "campaign.csv"),
        (8, "identity.hex"),
        (0, "new.toml"),
        (3, "new.bin"),
    ] {
        let (status, text) = on_a_full_disk(folder, &writing(WRITERS[writer], file));
        assert_eq!(status.code(), Some(2), "{file}: {text}");
        assert!(text.starts_with(&format!("error: {file}: ")) && text.contains("as it was"), "{text}");
        assert!(contents(folder) == before, "{file}");
    }
}

#[test]
fn an_answer_that_nobody_can_take_is_an_error_and_no_panic() {
    let folder = worked_in();
    for arguments in [
        vec!["inspect", "small.csv"],
        vec!["compare", "model.toml", "small.csv", "--json"],
        vec!["effects"],
        vec!["--help"],
        vec!["train", "--help"],
    ] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
        let mut command = std::process::Command::new(TEMPCO);
        let output = command.current_dir(folder.path()).args(&arguments).stdout(full).output().expect("it runs");
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains("standard output: No space left") && !text.contains("panicked"), "{text}");

        let mut command = std::process::Command::new(TEMPCO);
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = command.current_dir(folder.path()).args(&arguments).stdout(writer).output().expect("it runs");
        assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(141), &b""[..]), "{arguments:?}");
    }
}

#[test]
fn a_secret_key_is_its_owners_and_no_key_is_ever_overwritten() {
    let folder = worked_in();
    let folder = folder.path();
    let mode = |file: &str| fs::metadata(folder.join(file)).expect("written").permissions().mode() & 0o777;
    assert_eq!(mode("factory.key"), 0o600);
    assert_eq!(mode("model.toml"), mode("calibration.bin"));
    assert_eq!(mode("factory.pub") & 0o044, mode("model.toml") & 0o044);
    let before = contents(folder);
    fs::rename(folder.join("factory.key"), folder.join("elsewhere.key")).expect("moved");
    assert!(said(folder, 2, &["device", "keygen", "-o", "factory"]).contains("never overwritten"));
    fs::rename(folder.join("elsewhere.key"), folder.join("factory.key")).expect("moved");
    assert!(contents(folder) == before);
}

#[test]
fn a_calibration_as_hex_takes_away_what_the_second_slot_held() {
    let folder = worked_in();
    let text = fs::read_to_string(folder.path().join("calibration.hex")).expect("written");
    // The region is 256 KiB from 0x080C0000: its second half begins at 0x080E0000, and the mark stands in front of its data.
    let (_, second) = text.split_once(":02000004080EE4\n").expect("a piece in the second sector");
    let data: Vec<&str> = second.lines().take_while(|line| !line.starts_with(":00000001")).collect();
    // The storage's own mark, which `tests/power_loss.rs` knows.
    let (at, mark) = firmware_core::storage::empty_slot();
    let digits: String = mark.iter().map(|byte| format!("{byte:02X}")).collect();
    assert!(data.len() == 1 && data[0].starts_with(&format!(":10{at:04X}00{digits}")), "{second}");
}
