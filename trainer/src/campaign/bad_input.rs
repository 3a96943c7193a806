//! Every bad table gets its place, what was found, what was expected, and a way out.
//!
//! A case is three lines: the table (`⏎` ends a line, `HEAD` are the required columns) and how to read it,
//! the error, and the way out.

use super::tests::Folder;
use super::*;

/// The required columns.
pub(super) const HEAD: &str = "time_s,delta_f_hz,temperature_c,reference_g";

const HEADERS: &str = r#"
⏎
    run.csv: found no content, expected a line of column names and rows below it
    Remove the file, or export it again.

# nothing but⏎⏎# comments⏎
    run.csv: found no content, expected a line of column names and rows below it
    Remove the file, or export it again.

# made by x⏎⏎HEAD⏎
    run.csv:3: found column names only, expected rows below them
    Remove the file, or export it again with its rows.

0,1,2,3⏎1,1,2,3⏎
    run.csv:1: found numbers (0, 1, 2, 3), expected the names of the columns
    Name the columns in the first line, without #; if the file belongs to something else, name the others one by one.

time_s,delta_f_hz,Temp_C,reference_g⏎0,1,2,3⏎
    run.csv:1: found columns time_s, delta_f_hz, Temp_C, reference_g, expected a column temperature_c
    If "Temp_C" holds it, say so: --map "temperature_c=Temp_C".

timestamp	FreqDiff	imu.temperature⏎0	1	2⏎
    run.csv:1: found columns timestamp, FreqDiff, imu.temperature, expected columns time_s, delta_f_hz (or f1_hz and f2_hz), temperature_c, reference_g
    Name what holds them, perhaps --map "time_s=timestamp" --map "delta_f_hz=COLUMN" --map "temperature_c=imu.temperature" --map "reference_g=COLUMN"; another quantity: --signal COLUMN --signal-unit UNIT; a sensor that lies still may state constant_reference = 0.0 in campaign.toml.

when,delta_f_hz,temperature_c,reference_g⏎0,1,2,3⏎
    run.csv:1: found columns when, delta_f_hz, temperature_c, reference_g, expected a column time_s
    Name what holds it: --map time_s=COLUMN; rows at a fixed rate need no clock: --map "time_s=row*0.1".

time_s,delta_f_hz,temperature_c⏎0,1,2⏎
    run.csv:1: found columns time_s, delta_f_hz, temperature_c, expected a column reference_g
    Name what holds it: --map reference_g=COLUMN; a sensor that lies still may state constant_reference = 0.0 in campaign.toml.

time_s,temperature_c,reference_g⏎0,1,2⏎
    run.csv:1: found columns time_s, temperature_c, reference_g, expected a column delta_f_hz (or f1_hz and f2_hz)
    Name what holds it: --map delta_f_hz=COLUMN; another quantity: --signal COLUMN --signal-unit UNIT.

time_s,f1_hz,temperature_c,reference_g⏎0,1,2,3⏎
    run.csv:1: found f1_hz without f2_hz, expected delta_f_hz alone, or both f1_hz and f2_hz
    Map the other frequency as well, or leave this one out with `ignore` in campaign.toml.

HEAD,f2_hz⏎0,1,2,3,4⏎
    run.csv:1: found f2_hz without f1_hz, expected delta_f_hz alone, or both f1_hz and f2_hz
    Map the other frequency as well, or leave this one out with `ignore` in campaign.toml.

HEAD,supply_v,supply_v⏎0,1,2,3,4,5⏎
    run.csv:1, column 6 (supply_v): found the name of column 5 again, expected a name of its own
    Rename one of them, or leave both out: ignore = ["supply_v"] in campaign.toml.

HEAD⏎0,1,2,3⏎ --constant 1.0
    run.csv:1: found a column reference_g beside the constant reference 1.0, expected one of them
    Remove the constant reference, or the column: ignore = ["reference_g"] in campaign.toml.

HEAD⏎0,1,2,3⏎ --constant NaN
    run.csv:1: found NaN, expected a finite number as the constant reference
    Write it like time_s=COLUMN*1e-9, temperature_c=COLUMN/1.8-17.7778, time_s=row*0.1 or temperature_c=21.5.

HEAD⏎0,1,2,3⏎ --map supply_v=Supply
    run.csv:1: found columns time_s, delta_f_hz, temperature_c, reference_g, expected the column Supply that supply_v is mapped to
    Name what holds it: --map supply_v=COLUMN.

HEAD⏎0,1,2,3⏎ --map delta_f_hz=delta_f * 2
    run.csv:1: found columns time_s, delta_f_hz, temperature_c, reference_g, expected the column delta_f that delta_f_hz is mapped to
    The table has delta_f_hz under that name: leave its mapping out.

HEAD⏎0,1,2,3⏎ --map delta_f_hz=delta_f_hz*two
    run.csv:1: found "delta_f_hz*two" for delta_f_hz, expected COLUMN, COLUMN*factor+offset, row*seconds or a number
    Write it like time_s=COLUMN*1e-9, temperature_c=COLUMN/1.8-17.7778, time_s=row*0.1 or temperature_c=21.5.

HEAD⏎0,1,2,3⏎ --map delta_f_hz=
    run.csv:1: found "" for delta_f_hz, expected COLUMN, COLUMN*factor+offset, row*seconds or a number
    Write it like time_s=COLUMN*1e-9, temperature_c=COLUMN/1.8-17.7778, time_s=row*0.1 or temperature_c=21.5.

HEAD,a,b,c,d,e,f,g,h,i,j⏎0,1,2,3,4,5,6,7,8,9,10,11,12,13⏎
    run.csv:1: found 10 auxiliary channels, too many by i, j, expected at most 8
    Select with `channels` in campaign.toml, for example channels = ["a", "b", "c", "d", "e", "f", "g", "h"].

HEAD,supply_v⏎0,1,2,3,4⏎ --channels suply_v
    run.csv:1: found columns time_s, delta_f_hz, temperature_c, reference_g, supply_v, expected the channel suply_v that `channels` names
    If "supply_v" holds it, say so: --map "suply_v=supply_v".
"#;

const CELLS: &str = r#"
# a comment⏎⏎HEAD⏎0,1,2,3⏎⏎# another⏎1,1,2⏎
    run.csv:7: found 3 cells, expected 4, as in the header
    Complete or remove the row; text that contains the separator needs quotes, and numbers need a decimal point.

HEAD␍⏎0,1,2,3␍⏎1,1,2,3,4␍⏎
    run.csv:3: found 5 cells, expected 4, as in the header
    Complete or remove the row; text that contains the separator needs quotes, and numbers need a decimal point.

HEAD⏎0,1,2,3⏎1,1,warm,3⏎
    run.csv:3, column 3 (temperature_c): found "warm", expected a number
    Correct the cell or remove the row.

HEAD⏎08:15:00,1,25,3⏎
    run.csv:2, column 1 (time_s): found "08:15:00", expected a number
    Write time in seconds; rows at a fixed rate need no clock: --map "time_s=row*0.1".

time_s;delta_f_hz;temperature_c;reference_g⏎0;1;25,3;1⏎
    run.csv:2, column 3 (temperature_c): found "25,3", expected a number
    Write numbers with a decimal point instead of a comma, and without separators of thousands.

HEAD⏎0,1,2,⏎
    run.csv:2, column 4 (reference_g): found an empty cell, expected a number
    Fill the cell or remove the row.

HEAD⏎0,1,2,3⏎1,NaN,2,3⏎
    run.csv:3, column 2 (delta_f_hz): found "NaN", expected a finite number
    Remove the row (a gap in time is fine).

HEAD⏎0,1,2,-inf⏎
    run.csv:2, column 4 (reference_g): found "-inf", expected a finite number
    Remove the row (a gap in time is fine).

HEAD⏎0,1,2,1e999⏎
    run.csv:2, column 4 (reference_g): found 1e999, expected a number from -9.2e12 to 9.2e12
    Check the unit; another one is a factor: --map "reference_g=reference_g*1e-3".

HEAD⏎-1,1,2,3⏎
    run.csv:2, column 1 (time_s): found -1, expected a number from 0 to 9.2e12
    Begin at another zero: --map "time_s=time_s+10".

HEAD⏎0,1,25000,3⏎
    run.csv:2, column 3 (temperature_c): found 25000, expected a number from -2147.48 to 2147.48
    Check the unit; another one is a factor: --map "temperature_c=temperature_c*1e-3".

HEAD⏎0,1e13,25,3⏎
    run.csv:2, column 2 (delta_f_hz): found 1e13, expected a number from -9.2e12 to 9.2e12
    Check the unit; another one is a factor: --map "delta_f_hz=delta_f_hz*1e-3".

HEAD,age_days⏎0,1,2,3,50000⏎
    run.csv:2, column 5 (age_days): found 50000, expected a number from 0 to 49710
    Check the unit; another one is a factor: --map "age_days=age_days*1e-3".

HEAD,reference_sigma_g⏎0,1,2,3,-0.1⏎
    run.csv:2, column 5 (reference_sigma_g): found -0.1, expected a standard uncertainty, not below 0
    Check the sign, and that the mapping names the right column.

time_s,f1_hz,f2_hz,temperature_c,reference_g⏎0,1,-1,2,3⏎
    run.csv:2, column 3 (f2_hz): found -1, expected a number from 0 to 9.2e12
    Check the sign, and that the mapping names the right column.

HEAD,supply_v⏎0,1,2,3,3.3⏎1,1,2,3,n/a⏎
    run.csv:3, column 5 (supply_v): found "n/a", expected a number
    Correct the cell or remove the row; if nobody needs the column: ignore = ["supply_v"] in campaign.toml.

HEAD,supply_v⏎0,1,2,3,n/a⏎1,1,2,3,n/a⏎2,1,2,3,3.3⏎
    run.csv:2, column 5 (supply_v): found "n/a", expected a number, as in rows below it
    Correct the cell or remove the row; if nobody needs the column: ignore = ["supply_v"] in campaign.toml.

HEAD,note⏎0,1,2,3,⏎1,1,2,3,7⏎
    run.csv:2, column 5 (note): found an empty cell, expected a number, as in rows below it
    Fill the cell or remove the row; if nobody needs the column: ignore = ["note"] in campaign.toml.

HEAD,note⏎0,1,2,3,hot⏎ --channels note
    run.csv:2, column 5 (note): found "hot", expected a number
    Correct the cell or remove the row; if nobody needs the column: ignore = ["note"] in campaign.toml.

HEAD,run⏎0,1,2,3,a⏎1,1,2,3,⏎
    run.csv:3, column 5 (run): found an empty cell, expected a name
    Fill the cell or remove the row.

t,delta_f_hz,temperature_c,reference_g⏎9999,1,2,3⏎ --map time_s=t*1e10
    run.csv:2, column 1 (t as time_s): found 9999, expected a number from 0 to 9.2e12
    Write it in seconds: --map "time_s=t*1e-6" for microseconds, *1e-9 for nanoseconds.

time_s,f1_hz,f2_hz,delta_f_hz,temperature_c,reference_g⏎0,41238.25,41162.25,76.02,2,3⏎
    run.csv:2, column 4 (delta_f_hz): found 76.02, expected f1_hz - f2_hz = 76
    Check which columns are f1, f2, their difference and sum; `ignore` in campaign.toml leaves the wrong one out.

time_s,f1_hz,f2_hz,sum_f_hz,temperature_c,reference_g⏎0,41238,41162,82402.5,2,3⏎
    run.csv:2, column 4 (sum_f_hz): found 82402.5, expected f1_hz + f2_hz = 82400
    Check which columns are f1, f2, their difference and sum; `ignore` in campaign.toml leaves the wrong one out.
"#;

const RUNS: &str = r#"
HEAD⏎0,1,2,3⏎1.5,1,2,3⏎1.5000001,1,2,3⏎
    run.csv:4, column 1 (time_s): found 1.5 s again, expected more than the 1.5 s of the row before in run
    Sort the rows by time and leave out what is there twice; if a new recording begins here, name it in a column `run` or give it its own file.

run,HEAD⏎a,5,1,2,3⏎b,0,1,2,3⏎a,4.5,1,2,3⏎
    run.csv:4, column 2 (time_s): found 4.5 s, expected more than the 5 s of the row before in a
    Sort the rows by time and leave out what is there twice; if a new recording begins here, name it in a column `run` or give it its own file.

run,kind,HEAD⏎a,full,0,1,2,3⏎b,ramp,0,1,2,3⏎a,ramp,1,1,2,3⏎
    run.csv:4, column 2 (kind): found "ramp", expected "full", as in the rows of a above
    Give all rows of a run the same kind, or make two runs of it.
"#;

/// Error and way out, without the folder's own name.
pub(super) fn told(folder: &Folder, error: &CampaignError) -> String {
    let place = format!("{}/", folder.path().display());
    format!("{error}\n    {}", error.help()).replace(&place, "")
}

fn check(cases: &str) {
    for case in cases.split("\n\n").map(str::trim) {
        let (input, expected) = case.split_once("\n    ").expect("a table and what is said of it");
        let (table, options) = input.split_once(" --").unwrap_or((input, ""));
        let table = table.replace("HEAD", HEAD).replace('⏎', "\n").replace('␍', "\r");
        let folder = Folder::with(&[("run.csv", table.as_bytes())]);
        let refused = Campaign::read(&[folder.file("run.csv")], &parsed(options)).expect_err(case);
        assert_eq!(told(&folder, &refused), expected, "{input}");
    }
}

/// `map OURS=THEIRS`, `channels NAME` or `constant NUMBER`.
fn parsed(option: &str) -> ReadOptions {
    let mut options = ReadOptions::default();
    match option.split_once(' ') {
        Some(("map", map)) => {
            let (name, text) = map.split_once('=').expect("a mapping");
            options.map.insert(name.to_owned(), text.to_owned());
        }
        Some(("channels", name)) => options.channels = Some(vec![name.to_owned()]),
        Some(("constant", number)) => options.constant_reference = number.parse().ok(),
        _ => assert_eq!(option, ""),
    }
    options
}

#[test]
fn a_bad_header_is_refused() {
    check(HEADERS);
}

#[test]
fn a_bad_cell_is_refused() {
    check(CELLS);
}

#[test]
fn bad_runs_are_refused() {
    check(RUNS);
}
