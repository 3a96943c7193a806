//! What a scenario accepts, and what it says when it does not.

use super::*;

const MINIMAL: &str = "name = 'a'\n[[run]]\nname = 'z'\nkind = 'zero'\n";

#[test]
fn every_preset_can_be_carried_out_and_survives_writing() {
    for name in Scenario::preset_names() {
        let scenario =
            Scenario::from_toml(Scenario::preset_toml(name).unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(scenario.name, name);
        assert_eq!(Scenario::from_toml(&scenario.to_toml()), Ok(scenario), "{name}");
    }
    assert!(Scenario::preset("no such scenario").is_none());
}

#[test]
fn runs_follow_each_other_after_the_pause_or_at_their_age() {
    let text = format!("{MINIMAL}repeat = 2\n[[run]]\nname = 'late'\nkind = 'zero'\nage_days = 30\n");
    let scenario = Scenario::from_toml(&text).unwrap();
    let timeline = scenario.timeline(0).unwrap();
    let plan: Vec<_> = timeline.runs.iter().map(|run| (run.name.as_str(), run.begins_s)).collect();
    assert_eq!(plan, [("z-1", 0.0), ("z-2", 5400.0 + 43_200.0), ("late", 30.0 * 86_400.0)]);
}

#[test]
fn mistakes_say_where_and_what_to_do() {
    let cases = [
        ("name = 'a'\nrun = []", "the scenario has no run; add at least one `[[run]]`"),
        (&format!("{MINIMAL}[effects.no-such]"), "unknown field `no-such`, expected one of `thermal-lag`"),
        (
            &format!("{MINIMAL}[effects.thermal-lag]\ntau_s = -1"),
            "in [effects.thermal-lag]: `tau_s` is -1; it must be between",
        ),
        (&format!("{MINIMAL}[rig]\nroom = 3"), "unknown field `room`"),
        (&format!("{MINIMAL}record_every_s = 9000"), "run `z` keeps no sample of a part that lasts 5400 s"),
        (&format!("{MINIMAL}[[run]]\nname = 'z'\nkind = 'zero'"), "two runs are named `z`"),
        (
            &format!("{MINIMAL}[[run]]\nname = 'y'\nkind = 'zero'\nage_days = 0.01"),
            "run `y` begins at age 0.01 days, but",
        ),
        (&format!("{MINIMAL}duration_s = 2e7\nrepeat = 10"), "20000000"),
    ];
    for (text, expected) in cases {
        let error = Scenario::from_toml(text).expect_err(text).to_string();
        assert!(error.contains(expected), "{text}\n{error}");
    }
}

/// Every number of a table, and of the tables in it, replaced by `value`, one at a time; with its key. Counts are
/// replaced by one that is too large.
fn spoilt(table: &toml::Table, value: f64) -> Vec<(String, toml::Table)> {
    let mut all = Vec::new();
    for (key, old) in table {
        let mut put = |new: toml::Value, name: String| {
            let mut table = table.clone();
            table.insert(key.clone(), new);
            all.push((name, table));
        };
        match old {
            toml::Value::Float(_) => put(value.into(), key.clone()),
            toml::Value::Integer(_) => put(toml::Value::Integer(4_000_000_000), key.clone()),
            toml::Value::Table(inner) => {
                spoilt(inner, value).into_iter().for_each(|(name, table)| put(table.into(), name));
            }
            toml::Value::Array(entries) => {
                for (index, entry) in entries.iter().enumerate() {
                    let mut new = |entry: toml::Value, name: String| {
                        let mut entries = entries.clone();
                        entries[index] = entry;
                        put(entries.into(), name);
                    };
                    match entry {
                        toml::Value::Table(inner) => {
                            spoilt(inner, value).into_iter().for_each(|(name, table)| new(table.into(), name));
                        }
                        toml::Value::Float(_) => new(value.into(), key.clone()),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    all
}

#[test]
fn every_number_is_bounded_on_both_sides_and_the_refusal_names_its_key() {
    let mut seen = 0;
    for kind in kind::Kind::NAMES {
        let text = format!(
            "name = 'a'\n[[run]]\nname = 'z'\nkind = '{kind}'\nage_days = 1\n[[run.bad_state]]\ntemperature_c = 20\nposition_deg = 0\ndelta_f_hz = 1\n"
        );
        let mut scenario = Scenario::from_toml(&text).unwrap();
        for name in Effects::NAMES {
            scenario.effects.switch_on(name, 1.0);
        }
        let table: toml::Table = scenario.to_toml().parse().unwrap();
        for number in [1e308, -1e308, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (key, table) in spoilt(&table, number) {
                let text = toml::to_string(&table).unwrap();
                let error = Scenario::from_toml(&text).map(|_| ()).expect_err(&format!("{kind}: {key} = {number}"));
                assert!(error.to_string().contains(&key), "{kind}: {key} = {number}: {error}");
                seen += 1;
            }
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn what_no_memory_holds_and_nobody_waits_for_is_refused_at_once() {
    let run =
        |kind: &str, more: &str| format!("name = 'a'\nstep_s = 0.01\n[[run]]\nname = 'z'\nkind = '{kind}'\n{more}");
    let list = |value: f64| format!("{:?}", vec![value; 360]);
    let many = format!(
        "temperatures_c = {}\npositions_deg = {}\noffsets_pct = {}\ndwell_s = 1e-2\nrecord_every_s = 0.01\nsettle_s = 0",
        list(20.0),
        list(1.0),
        list(1.0)
    );
    for (text, expected) in [
        (run("zero", "duration_s = 3e7\nrecord_every_s = 0.01"), "samples"),
        (run("soak", "dwell_s = 3e7\nrecord_every_s = 3e7\nrepeat = 1000"), "time steps"),
        (run("supply", &many), "parts"),
        (
            run("tumble", "positions = 360\ndwell_s = 0.01\nrecord_every_s = 0.01\nsettle_s = 0.01\nrepeat = 1000"),
            "parts",
        ),
        (run("full", &format!("nodes_c = {:?}", vec![20.0; 361])), "`nodes_c` is a list of 361 entries"),
    ] {
        let error = Scenario::from_toml(&text).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("limit") | error.contains("at most"), "{expected}: {error}");
    }
}

#[test]
fn the_readme_lists_every_kind_and_every_preset_with_its_samples() {
    let readme = include_str!("../../scenarios/README.md");
    for kind in kind::Kind::NAMES {
        assert!(readme.contains(&format!("`{kind}`")), "{kind}");
    }
    for name in Scenario::preset_names() {
        let rows = Scenario::preset(name).unwrap().rows().unwrap();
        let samples = format!("{} {:03}", rows / 1000, rows % 1000);
        let line = readme.lines().find(|line| line.starts_with('|') && line.contains(&format!("`{name}`")));
        assert!(line.is_some_and(|line| line.contains(&samples)), "{name}: {samples} samples");
    }
}
