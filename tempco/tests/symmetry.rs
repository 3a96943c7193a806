//! Claim: what does not change the physics does not change what the commands say: `train`, `diagnose`, `add`, `compare` and
//! `plan`, one after the other, over the same measurements written in another way.

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// What tells the common effects apart, on a sensor that the thermometer is ahead of.
const SCENARIO: &str =
    concat!(include_str!("../../tests/scenarios/short.toml"), "\n[effects.thermal-lag]\ntau_s = 40.0\n");

fn run(folder: &Path, code: i32, arguments: &[&str]) -> (String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    command.current_dir(folder).env("NO_COLOR", "1").args(arguments);
    let output = command.assert().code(code).get_output().clone();
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (text(output.stdout), text(output.stderr))
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let (text, _) = run(folder, 0, &[arguments, &["--json"]].concat());
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// A table, cell by cell.
#[derive(Clone)]
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn measured(folder: &Path) -> Self {
        fs::write(folder.join("scenario.toml"), SCENARIO).expect("written");
        run(folder, 0, &["simulate", "scenario.toml", "--seed", "1", "-o", "measured.csv"]);
        let text = fs::read_to_string(folder.join("measured.csv")).expect("written");
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        Self { header: cells(lines.next().expect("a header")), rows: lines.map(cells).collect() }
    }

    fn place(&self, name: &str) -> usize {
        self.header.iter().position(|other| other == name).expect("the column is there")
    }

    /// A column in other words, under another name.
    fn with(mut self, name: &str, other: &str, change: impl Fn(&str) -> String) -> Self {
        let place = self.place(name);
        other.clone_into(&mut self.header[place]);
        self.rows.iter_mut().for_each(|row| row[place] = change(&row[place]));
        self
    }

    fn without(mut self, names: &[&str]) -> Self {
        for name in names {
            let place = self.place(name);
            self.header.remove(place);
            self.rows.iter_mut().for_each(|row| drop(row.remove(place)));
        }
        self
    }

    /// Every row so often.
    fn repeated(mut self, times: usize) -> Self {
        self.rows = self.rows.into_iter().flat_map(|row| std::iter::repeat_n(row, times)).collect();
        self
    }

    fn write(&self, file: &Path) {
        let lines = std::iter::once(&self.header).chain(&self.rows).map(|row| row.join(","));
        fs::write(file, lines.collect::<Vec<_>>().join("\n") + "\n").expect("written");
    }
}

/// A cell times a power of ten, to the last digit.
fn times_ten_to(power: i32) -> impl Fn(&str) -> String {
    move |cell| format!("{cell}e{power}")
}

fn negated(cell: &str) -> String {
    cell.strip_prefix('-').map_or_else(|| format!("-{cell}"), str::to_owned)
}

/// What all verbs say.
fn chain(table: &Table, options: &[&str]) -> [Value; 5] {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    table.write(&folder.join("c.csv"));
    let train = json(folder, &[&["train", "c.csv", "-o", "m.toml", "--restarts", "2"], options].concat());
    // Read as the model's campaign was.
    let diagnose = json(folder, &["diagnose", "m.toml", "c.csv"]);
    let add = json(folder, &["add", "m.toml", "thermal-lag", "c.csv", "-o", "a.toml"]);
    let compare = json(folder, &["compare", "a.toml", "c.csv"]);
    let plan = json(folder, &["plan", "m.toml", "c.csv", "--effects", "thermal-lag,thermal-gradient"]);
    [train, diagnose, add, compare, plan]
}

const NEAR: f64 = 0.03;

fn near(what: &str, one: &Value, other: &Value, factor: f64) {
    let [one, other] = [one, other].map(|value| value.as_f64().unwrap_or_else(|| panic!("{what}: {value}")));
    assert!((one * factor - other).abs() <= NEAR * other.abs(), "{what}: {one} times {factor}, and {other}");
}

/// `other` is what `one` is with references in units of 1/`factor`.
fn same(what: &str, one: &[Value; 5], other: &[Value; 5], factor: f64) {
    same_figures(what, one, other, factor);
    same_plan(what, &one[4], &other[4]);
}

fn same_figures(what: &str, one: &[Value; 5], other: &[Value; 5], factor: f64) {
    let [train, diagnose, add, compare] = [0, 1, 2, 3].map(|verb| (&one[verb], &other[verb]));
    for (verb, (one, other)) in [("train", train), ("diagnose", diagnose), ("add", add), ("compare", compare)] {
        for figure in ["residual_ug", "noise_floor_ug"] {
            near(&format!("{what}, {verb}: {figure}"), &one[figure], &other[figure], factor);
        }
    }
    let (one, other) = diagnose;
    assert_eq!((&one["verdict"], &one["unobservable"]), (&other["verdict"], &other["unobservable"]), "{what}");
    assert_eq!(
        (one["verdict"].as_str(), one["findings"].as_array().map(Vec::len)),
        (Some("missing"), Some(1)),
        "{what}"
    );
    let (a, b) = (&one["findings"][0], &other["findings"][0]);
    assert_eq!((&a["effect"], &a["confounded_with"]), (&b["effect"], &b["confounded_with"]), "{what}");
    near(&format!("{what}: evidence"), &a["evidence"], &b["evidence"], 1.0);
    near(&format!("{what}: tau_s"), &a["parameters"]["tau_s"]["value"], &b["parameters"]["tau_s"]["value"], 1.0);
    for rung in 0..2 {
        let residual_ug = |add: &Value| add["ladder"][rung]["residual_ug"].clone();
        near(&format!("{what}: rung {rung}"), &residual_ug(add.0), &residual_ug(add.1), factor);
    }
}

fn same_plan(what: &str, one: &Value, other: &Value) {
    let proposals = |plan: &Value| plan["proposals"].as_array().cloned().unwrap_or_default();
    let (ours, theirs) = (proposals(one), proposals(other));
    assert!(ours.len() > 5 && ours.len() == theirs.len(), "{what}: {} and {}", ours.len(), theirs.len());
    assert_eq!(ours[0]["recording"], theirs[0]["recording"], "{what}");
    for a in &ours {
        let b = theirs.iter().find(|b| b["recording"] == a["recording"]).expect("the same recordings");
        near(&format!("{what}: {}", a["recording"]), &a["sigma"], &b["sigma"], 1.0);
        assert_eq!(a["hours"], b["hours"], "{what}");
    }
}

#[test]
fn wiring_orientation_names_and_clock_change_nothing_that_any_verb_says() {
    let folder = TempDir::new().expect("a folder");
    let table = Table::measured(folder.path()).without(&["delta_f_hz", "sum_f_hz"]);
    let one = chain(&table, &[]);
    let same_word = str::to_owned;
    let swapped =
        table.clone().with("f1_hz", "x", same_word).with("f2_hz", "f1_hz", same_word).with("x", "f2_hz", same_word);
    same("forks swapped", &one, &chain(&swapped, &[]), 1.0);
    let over = table.clone().with("reference_g", "reference_g", negated);
    // A recording under 1 g is another recording to a sensor that stands on its head.
    same_figures("upside down", &one, &chain(&over, &[]), 1.0);
    let late = |cell: &str| format!("{:.3}", cell.parse::<f64>().expect("a number") + 5.0 * 365.0 * 86_400.0);
    let renamed = table.with("time_s", "time_s", late).with("run", "run", |name| format!("µ {name}"));
    same("five years later, under other names", &one, &chain(&renamed, &[]), 1.0);
}

#[test]
fn units_of_signal_and_reference_change_nothing_that_any_verb_says() {
    let folder = TempDir::new().expect("a folder");
    let table = Table::measured(folder.path()).without(&["f1_hz", "f2_hz"]);
    let one = chain(&table, &[]);
    for (power, factor) in [(-3, "*1000"), (3, "*0.001")] {
        let other = table.clone().with("delta_f_hz", "difference", times_ten_to(power));
        let map = format!("delta_f_hz=difference{factor}");
        assert_eq!(one, chain(&other, &["--map", &map]), "{map}");
    }
    let milli = table.clone().with("delta_f_hz", "difference", times_ten_to(3));
    let other = chain(&milli, &["--signal", "difference", "--signal-unit", "mHz"]);
    same("a signal in mHz beside a sum in Hz", &one, &other, 1.0);
    for (unit, power) in [("mg", 3), ("µg", 6)] {
        let other = table.clone().with("reference_g", "applied", times_ten_to(power));
        let other = chain(&other, &["--reference", "applied", "--reference-unit", unit]);
        same(unit, &one, &other, 10_f64.powi(power));
    }
}

#[test]
fn a_row_again_at_the_same_moment_is_refused_and_the_way_out_works() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let table = Table::measured(folder);
    table.clone().repeated(2).write(&folder.join("twice.csv"));
    let (_, text) = run(folder, 2, &["train", "twice.csv", "-o", "m.toml"]);
    assert!(text.starts_with("error: twice.csv:3, column 3 (time_s): found 3610 s again"), "{text}");
    assert!(text.contains("help: ") && text.contains("leave out what is there twice"), "{text}");
    table.write(&folder.join("once.csv"));
    run(folder, 0, &["train", "once.csv", "-o", "m.toml", "--restarts", "1"]);
}

#[test]
fn chamber_and_turntable_are_planned_for_accelerations_in_any_unit_and_for_nothing_else() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let table = Table::measured(folder).without(&["f1_hz", "f2_hz"]).with("reference_g", "load", str::to_owned);
    table.write(&folder.join("c.csv"));
    run(
        folder,
        0,
        &["train", "c.csv", "-o", "m.toml", "--restarts", "1", "--reference", "load", "--reference-unit", "N"],
    );
    let (_, text) = run(folder, 2, &["plan", "m.toml", "c.csv", "--effects", "thermal-lag,thermal-gradient"]);
    assert!(text.contains("this campaign's reference is in N, which is no known unit of acceleration"), "{text}");
}
