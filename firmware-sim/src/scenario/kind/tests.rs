//! Every kind of run, as the rows that it records.

use std::ops::ControlFlow;

use crate::recording::Row;
use crate::scenario::Scenario;
use crate::scenario::kind::Kind;
use crate::simulation::simulate;

/// The rows of one run of this kind with its defaults, changed by `more`.
fn rows(kind: &str, more: &str) -> Vec<Row> {
    let text = format!("name='t'\n[[run]]\nname='r'\nkind='{kind}'\n{more}");
    let scenario = Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{kind}: {error}"));
    simulate(&scenario, 1, &mut |_| ControlFlow::Continue(())).unwrap().runs.swap_remove(0).rows
}

/// Distinct values of a column in the order in which they first appear.
fn distinct(rows: &[Row], column: impl Fn(&Row) -> f64) -> Vec<f64> {
    let mut seen = Vec::new();
    for value in rows.iter().map(column) {
        if !seen.contains(&value) {
            seen.push(value);
        }
    }
    seen
}

#[test]
fn every_kind_records_with_its_defaults() {
    for kind in Kind::NAMES {
        let rows = rows(kind, "record_every_s = 10");
        assert!(!rows.is_empty(), "{kind}");
        assert!(rows.windows(2).all(|pair| pair[1].time_s > pair[0].time_s), "{kind}: time runs backwards");
    }
}

#[test]
fn a_full_run_is_the_papers() {
    let rows = rows("full", "");
    assert_eq!((rows.len(), rows[0].time_s, rows[120].time_s), (720, 3601.0, 7321.0));
    assert_eq!(distinct(&rows, |row| row.reference_g), [0.0, 1.0, -1.0]);
    assert_eq!(distinct(&rows[30..], |row| row.cross_g), [0.0, -1.0, 1.0]);
    // An hour of soak leaves 15 mK of a 20 K step, 49 mK of the first 65 K; the package is 0.3 K above.
    for (index, node_c) in [-40.0, -20.0, 0.0, 20.0, 40.0, 60.0].into_iter().enumerate() {
        let off_c = rows[index * 120].temperature_c - node_c - 0.3;
        assert!(off_c.abs() < 0.06, "{node_c} °C: {off_c}");
    }
}

#[test]
fn a_ramp_has_its_rate_in_the_middle_and_reaches_both_ends() {
    let rows = rows("ramp", "rates_k_per_min = [2]\nrecord_every_s = 10");
    let rates: Vec<f64> = rows.windows(13).map(|w| (w[12].truth.sensor_c - w[0].truth.sensor_c) / 2.0).collect();
    let [fastest, slowest] = [f64::max, f64::min].map(|pick| rates.iter().copied().fold(0.0, pick));
    assert!((fastest - 2.0).abs() < 0.01 && (slowest + 2.0).abs() < 0.01, "{fastest} {slowest}");
    let temperatures = || rows.iter().map(|row| row.truth.sensor_c);
    assert!((temperatures().fold(0.0, f64::max) - 60.3).abs() < 0.1);
    assert!((temperatures().fold(0.0, f64::min) + 39.7).abs() < 0.1);
}

#[test]
fn a_tumble_shuffles_its_positions_and_takes_every_one() {
    let rows = rows("tumble", "positions = 12\ntemperatures_c = [25]\nrecord_every_s = 10");
    let mut levels: Vec<f64> = rows.iter().map(|row| row.reference_g).collect();
    assert!(levels.windows(2).filter(|w| w[0] > w[1]).count() > 3, "not shuffled: {levels:?}");
    levels.sort_by(f64::total_cmp);
    for (index, level) in [-1.0, -0.866_025, -0.866_025, -0.5, -0.5, 0.0].into_iter().enumerate() {
        assert!((levels[index] - level).abs() < 1e-6, "{levels:?}");
    }
    assert!(rows.iter().all(|row| (row.reference_g.hypot(row.cross_g) - 1.0).abs() < 1e-12));
}

#[test]
fn the_second_mounting_reverses_the_cross_axis() {
    let at_level = |more| rows("static", more)[0].cross_g;
    assert_eq!((at_level(""), at_level("mount_rotation_deg = 180")), (1.0, -1.0));
}

#[test]
fn a_centrifuge_goes_beyond_one_g() {
    let rows = rows("static", "positions_deg = []\nlevels_g = [-20, 5, 20]");
    assert_eq!(distinct(&rows, |row| row.reference_g), [-20.0, 5.0, 20.0]);
}

#[test]
fn sweeps_set_what_they_sweep() {
    let supply = distinct(&rows("supply", ""), |row| (row.supply_v * 1e6).round() / 1e6);
    assert_eq!(supply, [4.75, 4.875, 5.0, 5.125, 5.25]);
    assert_eq!(distinct(&rows("vibration", ""), |row| row.vibration_g2), [0.0, 4.0, 16.0, 36.0]);
    assert_eq!(distinct(&rows("pressure", ""), |row| row.pressure_pa), [101_325.0, 90_000.0, 70_000.0, 50_000.0]);
    assert_eq!(distinct(&rows("humidity", "record_every_s = 600"), |row| row.humidity_pct), [40.0, 85.0]);
}

#[test]
fn after_every_power_on_the_clock_of_the_device_begins_anew() {
    let rows = rows("power-cycle", "record_every_s = 100");
    let starts = rows.iter().filter(|row| row.power_on_s == 100.0).count();
    assert_eq!((starts, rows.len()), (6, 6 * 27));
}

#[test]
fn a_soak_records_the_way_to_the_temperature() {
    let rows = rows("soak", "dwell_s = 7200\nrecord_every_s = 60");
    assert!(rows[0].temperature_c < 30.0 && (rows[119].temperature_c - 60.3).abs() < 0.05);
}

#[test]
fn what_cannot_be_carried_out_is_refused_with_its_key() {
    for (kind, more, expected) in [
        ("full", "nodes_c = [-300]", "`nodes_c` is -300"),
        ("ramp", "to_c = -40", "`to_c` is -40; it must be different from `from_c`"),
        ("tumble", "positions = 1", "`positions` is 1"),
        ("static", "positions_deg = []", "`positions_deg` is empty"),
        ("supply", "offsets_pct = []", "`offsets_pct` is an empty list"),
        ("power-cycle", "off_s = [0]", "`off_s` is 0"),
        ("zero", "mount_rotation_deg = 90", "`mount_rotation_deg` is 90; it must be 0 or 180"),
    ] {
        let text = format!("name='t'\n[[run]]\nname='r'\nkind='{kind}'\n{more}");
        let error = Scenario::from_toml(&text).unwrap_err().to_string();
        assert!(error.contains("in run `r`") && error.contains(expected), "{kind} {more}: {error}");
    }
}
