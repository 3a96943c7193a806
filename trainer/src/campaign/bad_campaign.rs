//! Every campaign that cannot be put together, taught from or arranged gets its facts and a way out.
//!
//! A case is three lines: what is attempted, the error, and the way out.

use super::bad_input::{HEAD, told};
use super::tests::Folder;
use super::*;
use std::path::PathBuf;

const FILES: &str = r#"
(none)
    the campaign: found no path, expected a .csv file or a folder of them
    Name the files or the folder of the campaign.

absent.csv
    absent.csv: found no such file or folder, expected a .csv file or a folder of them
    Check the path; a folder stands for all .csv files in it.

data.parquet
    data.parquet: found a Parquet file, expected a table as text: .csv
    Convert it: duckdb -c "COPY 'data.parquet' TO 'converted.csv'", or pandas' read_parquet and to_csv.

data.xlsx
    data.xlsx: found a name ending in ".xlsx", expected a table as text: .csv, .tsv or .txt
    Export it as text: commas, semicolons or tabs, column names in the first line.

data
    data: found a name without an ending, expected a table as text: .csv, .tsv or .txt
    Export it as text: commas, semicolons or tabs, column names in the first line.

empty
    empty: found no files, expected files ending in .csv
    Put the .csv files directly into this folder, or name the files one by one.

images
    images: found only one.png, expected files ending in .csv
    Put the .csv files directly into this folder, or name the files one by one.

latin.csv
    latin.csv:1: found byte 0xB0, expected UTF-8 text
    Convert it: iconv -f WINDOWS-1252 -t UTF-8 "latin.csv" > converted.csv (or -f UTF-16).

a.csv b.csv
    b.csv: found run a, which a.csv holds already, expected a name that no other file uses
    Rename one of the two, or give the file only once.

row.csv supply.csv
    row.csv: found no such column of numbers, expected supply_v, as in supply.csv
    Give every file a column of numbers supply_v, map one to that name, or leave it out: ignore = ["supply_v"] in campaign.toml.

supply.csv row.csv
    row.csv: found no such column of numbers, expected supply_v, as in supply.csv
    Give every file a column of numbers supply_v, map one to that name, or leave it out: ignore = ["supply_v"] in campaign.toml.

row.csv kg/row.csv
    kg/row.csv: found Hz against kg, expected Hz against g, as in the files before
    Name the same units for all files; a conversion is column = "load_lb*0.45359237".

bad
    bad/campaign.toml:3: found "colums = 3" (unknown field `colums`), expected one of `columns`, `signal`, `reference`, `channels`, `ignore`, `constant_reference`
    Correct the line; a mapping stands below [columns] and looks like delta_f_hz = "FreqDiff".

worse
    worse/campaign.toml:2: found "time_s = " (string values must be quoted), expected literal string
    Correct the line; a mapping stands below [columns] and looks like delta_f_hz = "FreqDiff".
"#;

const LESSONS: &str = r#"
run,HEAD⏎a,0,1,2,3⏎a,1,1,2,3⏎
    the campaign: found one run (a), expected two runs or more, to hold one out
    Add a second run; or divide this one with a column `run` where the recording was interrupted.

run,HEAD⏎a,0,1,2,3⏎b,1,1,2,3⏎
    the campaign: found 2 rows, expected at least 4
    Record longer, or add runs.

run,HEAD⏎a,0,1,2,3⏎a,1,2,2,4⏎b,0,3,2,3⏎b,1,4,2,4⏎
    the campaign, column temperature_c: found 2 in all 4 rows, expected values that vary
    Check that it is the sensor's thermometer; compensation needs runs over temperature.

run,HEAD⏎a,0,1,2,3⏎a,1,1,3,4⏎b,0,1,2,3⏎b,1,1,3,4⏎
    the campaign, column delta_f_hz: found 1 in all 4 rows, expected values that vary
    Check that it is the signal's column, and that the sensor was running.

run,HEAD⏎a,0,1e-6,2,3⏎a,1,2e-6,3,4⏎b,0,1e-6,2,3⏎b,1,9e-6,3,4⏎
    the campaign, column delta_f_hz: found a signal that spans 8 millionths of a Hz, expected 100 or more, because it is kept as a whole number of them
    Read it in a smaller unit: --signal "COLUMN*1e6" --signal-unit uV for a column in V.

run,HEAD⏎a,0,1,2,-0.5⏎a,1,2,3,-0.50⏎b,0,1,2,-5e-1⏎b,1,2,3,-0.5⏎
    the campaign, column reference_g: found -0.5 g in all 4 rows, expected a reference that varies
    Apply two accelerations or more (turn the sensor over), or state the slope that you know with --scale-factor.
"#;

const LACKS: &str = r#"
hold out run-3
    the campaign: found runs run-1, run-2, expected a run run-3 to hold out
    Did you mean --hold-out run-1?

hold out x
    the campaign: found runs run-1, run-2, expected a run x to hold out
    Name runs of this campaign after --hold-out, separated by commas.

hold out all
    the campaign: found nothing but run-2, run-1, expected a run to train on besides those held out
    Name fewer runs after --hold-out.

hold out of one run
    the campaign: found one run (run-1), expected two runs or more, to hold one out
    Add a second run; or divide this one with a column `run` where the recording was interrupted.

arrange supply_V
    the campaign: found channels supply_v, expected a channel supply_V
    If "supply_v" is the same quantity: --map "supply_V=supply_v".

arrange humidity
    the campaign: found channels supply_v, expected a channel humidity
    Give a campaign that records humidity, or a model without an effect that needs it.

arrange nine channels
    the campaign: found 9 auxiliary channels, too many by supply_v, expected at most 8
    Select with `channels` in campaign.toml, for example channels = ["supply_v", "supply_v", "supply_v", "supply_v", "supply_v", "supply_v", "supply_v", "supply_v"].
"#;

/// What is attempted and what is said of it.
fn cases(table: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    table.split("\n\n").map(|case| case.trim().split_once("\n    ").expect("an attempt and what is said of it"))
}

fn read(content: &str) -> (Folder, Campaign) {
    let folder = Folder::with(&[("run.csv", content.as_bytes())]);
    let campaign = Campaign::read(&[folder.file("run.csv")], &ReadOptions::default()).expect("a campaign");
    (folder, campaign)
}

#[test]
fn files_that_make_no_campaign() {
    let row = format!("{HEAD}\n0,1,2,3\n");
    let with_run = format!("run,{HEAD}\na,0,1,2,3\n");
    let with_supply = format!("{HEAD},supply_v\n0,1,2,3,4\n");
    let folder = Folder::with(&[
        ("row.csv", row.as_bytes()),
        ("a.csv", with_run.as_bytes()),
        ("b.csv", with_run.as_bytes()),
        ("supply.csv", with_supply.as_bytes()),
        ("latin.csv", b"time_s,Temp [\xB0C]\n0,1\n"),
        ("data.parquet", b"PAR1"),
        ("data.xlsx", b"PK"),
        ("data", b""),
        ("empty/.hidden.csv", b""),
        ("images/one.png", b""),
        ("kg/row.csv", row.as_bytes()),
        ("kg/campaign.toml", b"[reference]\ncolumn = \"reference_g\"\nunit = \"kg\"\n"),
        ("bad/row.csv", row.as_bytes()),
        ("bad/campaign.toml", b"ignore = []\n\ncolums = 3\n"),
        ("worse/row.csv", row.as_bytes()),
        ("worse/campaign.toml", b"[columns]\ntime_s = \n"),
    ]);
    for (names, expected) in cases(FILES) {
        let names = names.split(' ').filter(|&name| name != "(none)");
        let paths: Vec<PathBuf> = names.map(|name| folder.file(name)).collect();
        let refused = Campaign::read(&paths, &ReadOptions::default()).expect_err(expected);
        assert_eq!(told(&folder, &refused), expected);
    }
}

#[test]
fn campaigns_that_cannot_teach() {
    let demand = Demand { rows_min: 4, scale_factor_stated: false, one_run_will_do: false };
    for (table, expected) in cases(LESSONS) {
        let (folder, campaign) = read(&table.replace("HEAD", HEAD).replace('⏎', "\n"));
        let refused = campaign.check_trainable(&demand).expect_err(expected);
        assert_eq!(told(&folder, &refused), expected, "{table}");
    }
}

#[test]
fn a_demand_can_be_relaxed() {
    let (_folder, campaign) = read(&format!("{HEAD}\n0,1,2,3\n1,2,3,3\n"));
    let demand = Demand { rows_min: 2, scale_factor_stated: true, one_run_will_do: true };
    assert_eq!(campaign.check_trainable(&demand), Ok(()));
}

#[test]
fn what_a_campaign_lacks() {
    let (folder, two) = read(&format!("run,{HEAD},supply_v\nrun-1,0,1,2,3,4\nrun-2,0,1,2,3,4\n"));
    let one = Campaign { runs: two.runs[..1].to_vec(), ..two.clone() };
    let named = |names: &[&str]| HoldOut::Named(names.iter().map(|&name| name.to_owned()).collect());
    let attempts = [
        two.split(&named(&["run-3"])).map(drop),
        two.split(&named(&["x"])).map(drop),
        two.split(&named(&["run-2", "run-1"])).map(drop),
        one.split(&HoldOut::default()).map(drop),
        two.arranged(&["supply_V"]).map(drop),
        two.arranged(&["humidity"]).map(drop),
        two.arranged(&["supply_v"; 9]).map(drop),
    ];
    for (attempt, (_, expected)) in attempts.into_iter().zip(cases(LACKS)) {
        assert_eq!(told(&folder, &attempt.expect_err(expected)), expected);
    }
}
