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
    let timeline = Timeline::of(&scenario, 0).unwrap();
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
