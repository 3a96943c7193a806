//! No file takes all memory or all time: what no instrument recorded is refused in its place, in a short sentence.

use super::bad_input::{HEAD, told};
use super::tests::Folder;
use super::text::read_text;
use super::*;
use std::sync::mpsc::channel;
use std::time::Duration;

/// What is said of a file, which must be short and come soon.
fn said(folder: &Folder, name: &str) -> String {
    let (answer, answered) = channel();
    let file = folder.file(name);
    std::thread::spawn(move || {
        // Nobody listens once it took too long.
        let _ = answer.send(Campaign::read(&[file], &ReadOptions::default()));
    });
    let refused = answered.recv_timeout(Duration::from_secs(60)).expect("an answer").expect_err("refused");
    let text = told(folder, &refused);
    assert!(text.len() < 2000 && !refused.help().is_empty(), "{} bytes", text.len());
    text
}

fn refusal(content: &str) -> String {
    said(&Folder::with(&[("run.csv", content.as_bytes())]), "run.csv")
}

#[test]
fn a_line_of_a_hundred_million_characters_is_refused_wherever_it_stands() {
    let (longest, long) = ("7".repeat(100_000_000), "7".repeat(3 << 20));
    let row = "0,1,2,3";
    for (content, start) in [
        (longest, "run.csv:1: found a row of 95 MiB, expected at most 1 MiB"),
        (format!("{HEAD}\n{row}\n{long}\n"), "run.csv:3: found a row of 3 MiB"),
        (format!("{HEAD}\n0,{long},2,3\n"), "run.csv:2: found a row of 3 MiB"),
        (format!("{HEAD}\n# {long}\n0,\"1,2,3\n{long}"), "run.csv:3: found a row of 3 MiB"),
    ] {
        let text = refusal(&content);
        assert!(text.starts_with(start) && text.contains("every quote is closed"), "{text}");
    }
}

#[test]
fn a_million_columns_are_refused() {
    let names: String = (0..1_000_000).map(|k| format!(",c{k}")).collect();
    assert!(refusal(&format!("{HEAD}{names}\n")).starts_with("run.csv:1: found a row of 7 MiB"));
    let names: String = (0..2000).map(|k| format!(",c{k}")).collect();
    assert!(refusal(&format!("{HEAD}{names}\n")).starts_with("run.csv:1: found 2004 columns, expected at most 1000"));
    let names: String = (0..900).map(|k| format!(",c{k}")).collect();
    let text = refusal(&format!("when{names}\n0\n"));
    assert!(text.contains("c38 and 861 more") && !text.contains("c39"), "{text}");
}

#[test]
fn a_name_longer_than_a_sentence_is_refused() {
    let long = "x".repeat(5000);
    let text = refusal(&format!("{HEAD},{long}\n0,1,2,3,4\n"));
    assert!(text.starts_with("run.csv:1: found a name of 5 KiB, \"xxxx") && text.contains("in column 5"), "{text}");
    let text = refusal(&format!("run,{HEAD}\na,0,1,2,3\n{long},0,1,2,3\n"));
    assert!(text.starts_with("run.csv:3, column 1 (run): found a name of 5 KiB"), "{text}");
    let text = refusal(&format!("run,kind,{HEAD}\na,{long},0,1,2,3\n"));
    assert!(text.starts_with("run.csv:2, column 2 (kind): found a name of 5 KiB"), "{text}");
}

#[test]
fn a_number_of_many_digits_is_shown_in_part() {
    let text = refusal(&format!("{HEAD}\n0,{},2,3\n", "9".repeat(100_000)));
    assert!(text.contains("column 2 (delta_f_hz): found 9999") && text.contains("…, expected a number from"), "{text}");
}

#[test]
fn numbers_that_no_integer_of_the_instrument_holds_are_refused_in_their_place() {
    for (cells, column) in [
        ("0,1,2,1e30", "column 4 (reference_g): found 1e30"),
        ("0,1,2,-9.9e12", "column 4 (reference_g): found -9.9e12"),
        ("0,1e13,2,3", "column 2 (delta_f_hz): found 1e13"),
        ("0,1,2148,3", "column 3 (temperature_c): found 2148"),
        ("1.7e15,1,2,3", "column 1 (time_s): found 1.7e15"),
    ] {
        let text = refusal(&format!("{HEAD}\n0,1,2,3\n{cells}\n"));
        assert!(text.starts_with(&format!("run.csv:3, {column}, expected a number from")), "{text}");
    }
    let with_sigma = refusal(&format!("{HEAD},reference_sigma_g\n0,1,2,3,1e30\n"));
    assert!(with_sigma.contains("(reference_sigma_g): found 1e30"), "{with_sigma}");
    let options = ReadOptions { constant_reference: Some(1e30), ..ReadOptions::default() };
    let folder = Folder::with(&[("run.csv", b"time_s,delta_f_hz,temperature_c\n0,1,2\n")]);
    let refused = Campaign::read(&[folder.file("run.csv")], &options).expect_err("refused");
    assert!(told(&folder, &refused).contains("reference_g: found 1e30"), "{refused}");
}

#[test]
fn a_nul_is_no_text() {
    assert!(refusal(&format!("{HEAD}\n0,1,2,3\n1,\0,2,3\n")).starts_with("run.csv:3: found byte 0x00"));
    let utf16: Vec<u8> = HEAD.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let text = said(&Folder::with(&[("run.csv", &utf16)]), "run.csv");
    assert!(text.starts_with("run.csv:1: found byte 0x00") && text.contains("UTF-16"), "{text}");
}

#[test]
fn a_folder_a_device_and_a_pipe_are_no_files() {
    let folder = Folder::with(&[("a/b.csv/inner.csv", b"x")]);
    assert!(said(&folder, "a").starts_with("a/b.csv: found a folder, expected a file"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/zero", folder.file("zero.csv")).expect("a link");
        assert!(said(&folder, "zero.csv").starts_with("zero.csv: found a device, pipe or socket, expected a file"));
        let made = std::process::Command::new("mkfifo").arg(folder.file("pipe.csv")).status();
        assert!(made.is_ok_and(|status| status.success()));
        assert!(said(&folder, "pipe.csv").starts_with("pipe.csv: found a device, pipe or socket, expected a file"));
    }
}

#[test]
fn a_file_of_more_than_it_may_have_is_refused() {
    let folder = Folder::with(&[("run.csv", b"12345")]);
    assert_eq!(read_text(&folder.file("run.csv"), 5).as_deref(), Ok("12345"));
    let refused = read_text(&folder.file("run.csv"), 4).expect_err("one byte more");
    assert_eq!(refused.to_string().rsplit('/').next(), Some("run.csv: found 5 bytes, expected at most 4 bytes"));
}
