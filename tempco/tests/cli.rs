//! The command line as a user meets it: each verb on the checked-in campaign, and what it says when it can't.

#[path = "cli/changes.rs"]
mod changes;

use assert_cmd::Command;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SMALL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.csv");
const SMALL_SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.toml");

fn tempco(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    command.current_dir(folder).env("NO_COLOR", "1");
    command
}

fn stdout(command: &mut Command) -> String {
    let output = command.assert().success().get_output().stdout.clone();
    String::from_utf8(output).expect("text")
}

fn stderr_of(command: &mut Command, code: i32) -> String {
    let output = command.assert().code(code).get_output().stderr.clone();
    String::from_utf8(output).expect("text")
}

/// A folder with a model of the small campaign.
fn trained() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    tempco(folder.path()).args(["train", SMALL, "-o", "model.toml", "--restarts", "4"]).assert().success();
    folder
}

/// The small campaign with a supply column, and with an effect that only the two columns together explain.
fn with_supply(folder: &Path) {
    let small = fs::read_to_string(SMALL).expect("checked in");
    let mut lines = small.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let reference = header.iter().position(|name| *name == "reference_g").expect("a reference");
    let mut text = header.join(",") + ",supply_v\n";
    for (index, line) in lines.enumerate() {
        let supply_v = [4.75, 5.0, 5.25][index / 5 % 3];
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let level_g: f64 = cells[reference].parse().expect("a number");
        // The reading is too high by 1 mg/(V·g); the acceleration is lower than it says.
        cells[reference] = format!("{:.9}", level_g * (1.0 - 1e-3 * (supply_v - 5.0)));
        text += &format!("{},{supply_v}\n", cells.join(","));
    }
    fs::write(folder.join("supply.csv"), text).expect("a file");
}

#[test]
fn the_checked_in_campaign_is_what_its_scenario_gives() {
    let folder = TempDir::new().expect("a folder");
    stdout(tempco(folder.path()).args(["simulate", SMALL_SCENARIO, "--seed", "1", "-o", "again.csv"]));
    let written = fs::read_to_string(folder.path().join("again.csv")).expect("written");
    let (mark, table) = written.split_once('\n').expect("lines");
    assert!(mark.starts_with("# Written by tempco: a simulated campaign; SHA-256"), "{mark}");
    assert!(table == fs::read_to_string(SMALL).expect("checked in"));
}

#[test]
fn the_same_campaign_and_seed_give_the_same_model_byte_for_byte_on_one_thread_and_on_many() {
    let folder = TempDir::new().expect("a folder");
    for (file, threads) in [("one.toml", "1"), ("many.toml", "3")] {
        let mut command = tempco(folder.path());
        command.args(["train", SMALL, "-o", file, "--restarts", "4"]).env("RAYON_NUM_THREADS", threads);
        command.assert().success();
    }
    let read = |file| fs::read(folder.path().join(file)).expect("written");
    assert!(read("one.toml") == read("many.toml"));
}

#[test]
fn a_model_goes_from_training_over_export_to_a_verified_instrument() {
    let folder = trained();
    let text = stdout(tempco(folder.path()).args(["compare", "model.toml", SMALL]));
    assert!(text.starts_with("Residual ") && text.contains("Zero-bias stability"), "{text}");
    let text = stdout(tempco(folder.path()).args(["export", "model.toml", "-o", "calibration.hex"]));
    assert!(text.contains("for address 0x080c0000"), "{text}");
    let text = stdout(tempco(folder.path()).args(["inspect", "calibration.hex"]));
    assert!(text.contains("A device would take it."), "{text}");
    let verify = ["verify", "model.toml", SMALL];
    let text = stdout(tempco(folder.path()).args(verify));
    let (identical, all) = text.split_once(" of ").expect("two counts");
    assert!(all.starts_with(identical) && all.contains("identical in every bit"), "{text}");
    // At least as fast as the whole command, and not faster than any line.
    #[expect(clippy::disallowed_methods, reason = "how fast it is takes a clock")]
    let begun = std::time::Instant::now();
    let speed = stderr_of(tempco(folder.path()).args(verify), 0);
    let slowest_per_s = identical.parse::<f64>().expect("a count") / begun.elapsed().as_secs_f64();
    let per_s: f64 = speed.split(' ').next().and_then(|text| text.parse().ok()).unwrap_or_else(|| panic!("{speed}"));
    assert!((slowest_per_s - 1.0..1e9).contains(&per_s), "{speed}, at least {slowest_per_s}");
}

#[test]
fn other_programs_read_json() {
    let folder = trained();
    let text = stdout(tempco(folder.path()).args(["compare", "model.toml", SMALL, "--json"]));
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for key in ["residual_ug", "noise_floor_ug"] {
        assert!(value[key].as_f64().is_some_and(|number| number > 0.0), "{key}: {value}");
    }
    assert!(value["sensitivity_ppm"]["worst"].is_number() && value["runs"][0]["held_out"].is_boolean(), "{value}");
}

#[test]
fn a_diagnosis_answers_people_in_a_sentence_and_programs_in_json() {
    let folder = trained();
    let diagnose = |options: &[&str]| {
        let mut command = tempco(folder.path());
        command.args(["diagnose", "model.toml", SMALL]).args(options);
        command
    };
    let text = stdout(&mut diagnose(&[]));
    assert!(text.contains("Noise used:") && text.contains("\nNext:  tempco "), "{text}");
    assert!(text.contains("What this campaign can't show:") && text.contains("supply-voltage"), "{text}");

    let all = stdout(&mut diagnose(&["--all"]));
    assert!(!text.contains("Every effect that was judged") && all.contains("Every effect that was judged"), "{all}");

    let value: serde_json::Value = serde_json::from_str(&stdout(&mut diagnose(&["--json"]))).expect("JSON");
    let candidates = value["candidates"].as_array().expect("candidates");
    assert!(candidates.len() > 3, "{value}");
    for one in candidates {
        let [effect, reason] = ["effect", "reason"].map(|key| one[key].as_str().expect("words"));
        assert!(all.contains(&format!("\n  {effect} ")) && all.contains(reason), "{effect} {reason}: {all}");
        assert!(one["delta_bic"].is_number() && one["outcome"].is_string(), "{one}");
    }
    for key in ["residual_ug", "noise_floor_ug", "explainable"] {
        assert!(value[key].is_number(), "{key}: {value}");
    }
    assert!(value["findings"].is_array() && value["unobservable"].is_array(), "{value}");
    assert!(value.as_object().is_some_and(|object| object.contains_key("unexplained")), "{value}");
    let verdict = value["verdict"].as_str().expect("a verdict");
    assert!(["missing", "ambiguous", "nothing-missing", "unexplained"].contains(&verdict), "{verdict}");

    // The answer is the answer; only whoever asks for it makes it an exit code.
    let code = i32::from(verdict != "nothing-missing");
    diagnose(&["--fail-if-missing"]).assert().code(code);
}

#[test]
fn an_exceeded_limit_is_a_no_and_not_an_error() {
    let folder = trained();
    tempco(folder.path()).args(["compare", "model.toml", SMALL, "--fail-above", "0.5"]).assert().code(1);
    tempco(folder.path()).args(["compare", "model.toml", SMALL, "--fail-above", "500"]).assert().code(0);
}

#[test]
fn a_damaged_calibration_is_shown_as_what_a_device_would_refuse() {
    let folder = trained();
    stdout(tempco(folder.path()).args(["export", "model.toml", "-o", "calibration.bin"]));
    let path = folder.path().join("calibration.bin");
    let mut bytes = fs::read(&path).expect("written");
    bytes[100] ^= 4;
    fs::write(&path, bytes).expect("a file");
    let output =
        tempco(folder.path()).args(["inspect", "calibration.bin"]).assert().code(1).get_output().stdout.clone();
    assert!(String::from_utf8_lossy(&output).contains("A device would refuse this: corrupted"));
}

#[test]
fn every_failure_names_its_place_and_a_way_out() {
    let folder = TempDir::new().expect("a folder");
    let bad = folder.path().join("bad.csv");
    fs::write(&bad, "time_s,temperature_c,reference_g,delta_f_hz\n0,20,0,76\n1,warm,0,76\n").expect("a file");
    let table = [
        (vec!["train", "absent.csv"], "absent.csv"),
        (vec!["train", "bad.csv"], "bad.csv:3, column 2 (temperature_c)"),
        (vec!["train", SMALL, "--hold-out", "full-9"], "full-9"),
        (vec!["train", SMALL, "--map", "time_s"], "--map time_s"),
        (vec!["compare", "absent.toml", SMALL], "absent.toml"),
        (vec!["simulate", "nowhere"], "nowhere"),
        (vec!["effects", "thermal-leg"], "thermal-leg"),
    ];
    for (arguments, place) in table {
        let text = stderr_of(tempco(folder.path()).args(&arguments), 2);
        assert!(text.starts_with("error:") && text.contains(place), "{arguments:?}: {text}");
    }
}

#[test]
fn help_of_every_verb_has_an_example() {
    let folder = TempDir::new().expect("a folder");
    let verbs = [
        "demo", "simulate", "train", "compare", "diagnose", "plan", "effects", "add", "remove", "export", "inspect",
        "verify",
    ];
    for verb in verbs {
        let text = stdout(tempco(folder.path()).args([verb, "--help"]));
        assert!(text.contains(&format!("Example:  tempco {verb}")), "{verb}: {text}");
    }
}

#[test]
fn a_run_whose_name_has_a_comma_is_held_out_by_that_name() {
    let folder = TempDir::new().expect("a folder");
    let named =
        |from: &str, to: &str| fs::read_to_string(SMALL).expect("checked in").replace(from, &format!("\"{to}\","));
    fs::write(folder.path().join("c.csv"), named("full-2,", "full-1,zero-1")).expect("written");
    let held_out = |options: &[&str]| {
        let mut command = tempco(folder.path());
        let text = stdout(command.args(["train", "c.csv", "--restarts", "1", "--json"]).args(options));
        let told: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let runs = told["runs"].as_array().expect("runs").iter().filter(|run| run["held_out"] == true);
        runs.map(|run| run["run"].as_str().expect("a name").to_owned()).collect::<Vec<_>>()
    };
    // A run of exactly this name is meant rather than two others.
    assert_eq!(held_out(&["--hold-out", "full-1,zero-1"]), ["full-1,zero-1"]);
    assert_eq!(held_out(&["--hold-out", "full-1", "--hold-out", "zero-1"]), ["full-1", "zero-1"]);
    assert_eq!(held_out(&["--hold-out", "full-1,zero-1", "--hold-out", "zero-1,full-3"]).len(), 3);
    assert!(
        stderr_of(tempco(folder.path()).args(["train", "c.csv", "--hold-out", "full-1,zero-9"]), 2).contains("zero-9")
    );
}

#[test]
fn a_column_whose_name_has_a_comma_is_named_in_quotes_and_typed_again_like_that() {
    let folder = TempDir::new().expect("a folder");
    with_supply(folder.path());
    let path = folder.path().join("supply.csv");
    let table =
        fs::read_to_string(&path).expect("written").replacen("supply_v", "\"supply, V\",\"by \"\"hand\"\", °C\"", 1);
    let (head, rows) = table.split_once('\n').expect("lines");
    let rows: Vec<String> = rows.lines().map(|row| format!("{row},warm")).collect();
    fs::write(&path, format!("{head}\n{}\n", rows.join("\n"))).expect("written");
    let channels = ["--channels", "\"supply, V\""];
    let ignore = ["--ignore", "\"by \"\"hand\"\", °C\""];
    let mut command = tempco(folder.path());
    stdout(command.args(["train", "supply.csv", "-o", "model.toml", "--restarts", "1"]).args(channels).args(ignore));
    let model = fs::read_to_string(folder.path().join("model.toml")).expect("written");
    assert!(model.contains("channels = [\"supply, V\"]"), "{model}");
    let note = stderr_of(tempco(folder.path()).args(["compare", "model.toml", "supply.csv"]), 0);
    assert!(note.contains("--channels '\"supply, V\"' --ignore '\"by \"\"hand\"\", °C\"'"), "{note}");
    // Told apart from two columns, named one after the other or each for itself.
    let refused = |options: &[&str]| stderr_of(tempco(folder.path()).args(["inspect", "supply.csv"]).args(options), 2);
    for options in
        [["--channels", "supply, V", ignore[0], ignore[1]], [channels[0], channels[1], "--channels", "supply"]]
    {
        assert!(refused(&options).contains("supply"), "{options:?}");
    }
}

#[test]
fn the_restarts_of_a_training_are_told_one_by_one_and_by_their_quartiles() {
    let folder = TempDir::new().expect("a folder");
    let train = ["train", SMALL, "--restarts", "5"];
    let text = stdout(tempco(folder.path()).args(train));
    let after = |head: &str| text.lines().skip_while(|line| !line.trim_start().starts_with(head)).nth(1);
    let row: Vec<f64> = after("restarts").expect("a table").split_whitespace().flat_map(str::parse).collect();
    let in_order =
        text.lines().find_map(|line| line.trim_start().strip_prefix("in order, µg: ")).expect("each of them");
    let mut each: Vec<f64> = in_order.split(' ').flat_map(str::parse).collect();
    let told = stdout(tempco(folder.path()).args(train).arg("--json"));
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    let restarts = told["restarts"].as_array().expect("restarts");
    let converged = restarts.iter().filter(|restart| restart["converged"] == true).count();
    assert_eq!((row.len(), row[0], row[1], each.len()), (7, 5.0, converged as f64, 5), "{text}");
    for (restart, shown) in restarts.iter().zip(&each) {
        let residual_ug = restart["residual_ug"].as_f64().expect("a number");
        assert!((residual_ug - shown).abs() < 0.006 && residual_ug > 1.0, "{residual_ug} {shown}");
    }
    each.sort_by(f64::total_cmp);
    assert!(row[2..].iter().zip(&each).all(|(one, other)| (one - other).abs() < 0.006), "{row:?} {each:?}");
}

#[test]
fn a_cross_validation_takes_the_same_restarts_whatever_the_model_took() {
    let folder = TempDir::new().expect("a folder");
    let validated = |restarts: &str| {
        stdout(tempco(folder.path()).args(["train", SMALL, "-o", "model.toml", "--restarts", restarts]));
        let text = stdout(tempco(folder.path()).args(["compare", "model.toml", SMALL, "--cross-validate", "--json"]));
        let told: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        told["cross_validation"].clone()
    };
    let (one, two) = (validated("1"), validated("2"));
    assert!(one.is_object() && one == two, "{one:#} {two:#}");
}

#[test]
fn a_campaign_is_shown_run_by_run() {
    let folder = TempDir::new().expect("a folder");
    // Twelve rows 2 s apart, the last one after an hour; four at each level.
    let row = |k: usize| {
        let (time_s, level_g) = (if k == 11 { 3_600 } else { 2 * k }, [1.0, 0.0, -1.0][k / 4]);
        let temperature_c = [-10.5, 0.0, 12.25][k % 3];
        format!("one,tumble,{time_s},{temperature_c},{},{level_g}\n", 76.0 + 420.0 * level_g)
    };
    let rows: String = (0..12).map(row).collect();
    let table = format!("run,kind,time_s,temperature_c,delta_f_hz,reference_g\n{rows}two,zero,0,20,76,0\n");
    fs::write(folder.path().join("two.csv"), table).expect("written");
    let text = stdout(tempco(folder.path()).args(["inspect", "two.csv"]));
    let lines: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines[0], ["one", "tumble", "12", "2.00", "1.00", "-10.5", "12.2", "3"], "{text}");
    assert_eq!(lines[1], ["two", "zero", "1", "–", "0.00", "20.0", "20.0", "1"], "{text}");
}

#[test]
fn every_built_in_scenario_is_listed_with_what_it_is() {
    let folder = TempDir::new().expect("a folder");
    let text = stdout(tempco(folder.path()).arg("simulate"));
    for line in text.lines() {
        let (name, description) = line.split_once(' ').expect("a name and what it is");
        assert!(!description.trim().is_empty(), "{line}");
        let printed = stdout(tempco(folder.path()).args(["simulate", name, "--print"]));
        assert!(printed.contains(&format!("name = \"{name}\"")), "{printed}");
    }
    assert!(text.lines().count() > 3, "{text}");
}

#[test]
fn no_foreign_name_moves_a_cursor_whether_it_is_answered_remarked_or_refused() {
    const NASTY: &str = "a\u{1b}[31m\u{202e}b";
    let folder = TempDir::new().expect("a folder");
    let table = fs::read_to_string(SMALL).expect("checked in");
    fs::write(folder.path().join("nasty.csv"), table.replacen("delta_f_hz", NASTY, 1)).expect("written");
    let seen = |code: i32, arguments: &[&str]| {
        let output = tempco(folder.path()).args(arguments).assert().code(code).get_output().clone();
        let text = String::from_utf8([output.stdout, output.stderr].concat()).expect("text");
        // The parser's and the failures' own colours are not asked for.
        assert!(!text.contains('\u{1b}') && !text.contains('\u{202e}'), "{arguments:?}: {text:?}");
        text
    };
    let map = format!("delta_f_hz={NASTY}");
    seen(0, &["train", "nasty.csv", "--map", &map, "--restarts", "1", "-o", "m.toml"]);
    assert!(seen(0, &["inspect", "m.toml"]).contains("b\""), "the model's text");
    // A remark: how the model's campaign was read.
    assert!(seen(0, &["compare", "m.toml", "nasty.csv"]).contains("Read as the model's campaign was"));
    for arguments in [["inspect", NASTY], ["effects", NASTY], ["train", NASTY], ["simulate", NASTY]] {
        assert!(seen(2, &arguments).contains("\\u001b"), "{arguments:?}");
    }
    assert!(seen(2, &["train", "nasty.csv", "--map", NASTY]).contains("\\u001b"));
    // In what helps, too: it names the file once more.
    let file = format!("{NASTY}.csv");
    fs::write(folder.path().join(&file), b"time_s,\xFF\xFE\n").expect("written");
    let text = seen(2, &["train", &file]);
    let (error, help) = text.split_once("help:").expect("a way out");
    assert!(error.contains("\\u001b") && help.contains("\\u001b"), "{text}");
    // The parser of the command line quotes what it does not know.
    assert!(seen(2, &["train", &format!("--{NASTY}")]).contains("\\u202e"));
}

#[test]
fn every_run_may_teach_and_no_seed_is_too_large_for_the_files_that_name_it() {
    let folder = TempDir::new().expect("a folder");
    let text = stdout(tempco(folder.path()).args(["train", SMALL, "--hold-out", "none", "--restarts", "1", "--json"]));
    let told: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let runs = told["runs"].as_array().expect("runs");
    assert!(runs.len() == 7 && runs.iter().all(|run| run["held_out"] == false), "{text}");
    for verb in [&["simulate", SMALL_SCENARIO][..], &["demo"], &["train", SMALL]] {
        let text = stderr_of(tempco(folder.path()).args(verb).args(["--seed", "9223372036854775808"]), 2);
        assert!(text.contains("--seed <SEED>") && text.contains("9223372036854775807"), "{text}");
    }
}

#[test]
fn a_reference_of_another_name_and_unit_is_read_as_that() {
    let folder = TempDir::new().expect("a folder");
    let table = fs::read_to_string(SMALL).expect("checked in").replacen("reference_g", "load", 1);
    fs::write(folder.path().join("load.csv"), table).expect("written");
    let options = ["--reference", "load*9.80665", "--reference-unit", "m/s2", "--restarts", "1", "-o", "model.toml"];
    stdout(tempco(folder.path()).args(["train", "load.csv"]).args(options));
    let model = fs::read_to_string(folder.path().join("model.toml")).expect("written");
    assert!(model.contains("reference = \"m/s2\"") && model.contains("load*9.80665"), "{model}");
}
