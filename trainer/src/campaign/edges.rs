//! What lies exactly on a bound, and one step beyond it.

use super::limits::{MAX_COLUMNS, MAX_NAME, MAX_UPTIME_US};
use super::tests::{Folder, campaign, campaign_of, mapped};
use super::*;
use protocol::Sample;
use std::path::PathBuf;

const HEAD: &str = "time_s,delta_f_hz,temperature_c,reference_g";

/// A run of rows at these times, µs, in memory.
fn run(name: &str, times_us: &[u64]) -> Run {
    let row = |&time_us: &u64| Row {
        sample: Sample::from_difference(time_us, 0, 0),
        reference_g: 0.0,
        reference_sigma_g: None,
    };
    Run {
        name: name.to_owned(),
        kind: UNSTATED.to_owned(),
        source: PathBuf::new(),
        rows: times_us.iter().map(row).collect(),
    }
}

fn in_memory(runs: Vec<Run>) -> Campaign {
    Campaign::new(runs, Vec::new(), Quantity::default())
}

#[test]
fn what_is_remembered_across_thirty_intervals_of_the_slowest_run_or_its_longest_pause() {
    let second = 1_000_000;
    let fast = run("fast", &[0, second / 2, second]);
    let slow = run("slow", &[0, 2 * second, 4 * second, 6 * second]);
    let paused = run("paused", &[0, second, 2 * second, 102 * second]);
    assert_eq!(in_memory(vec![fast.clone()]).max_gap_us(), 30_000_000, "a second counts at least");
    assert_eq!(in_memory(vec![fast.clone(), slow.clone()]).max_gap_us(), 60_000_000);
    assert_eq!(in_memory(vec![fast, slow, paused]).max_gap_us(), 100_000_000);
    assert_eq!(in_memory(vec![run("years", &[0, u64::MAX / 2])]).max_gap_us(), u32::MAX);
}

#[test]
fn ten_years_are_an_uptime_and_a_microsecond_more_is_a_calendar() {
    assert!(!run("long", &[MAX_UPTIME_US]).has_calendar_time());
    assert!(run("calendar", &[MAX_UPTIME_US + 1]).has_calendar_time());
    assert!(run("from power-on", &[0, 1]).begins_with_power_on() && !run("later", &[1, 2]).begins_with_power_on());
    let read = |time: &str| campaign(&format!("{HEAD}\n{time},2,3,4\n")).runs[0].rows[0].sample.power_on_us;
    assert_eq!((read("316224000"), read("316224000.000001")), (MAX_UPTIME_US, 0));
}

#[test]
fn a_frequency_is_told_by_its_unit() {
    let is_frequency = |unit: &str| Quantity { signal_unit: unit.to_owned(), ..Quantity::default() }.is_frequency();
    assert!(Quantity::default().is_frequency() && is_frequency("kHz") && !is_frequency("mV") && !is_frequency("m/s²"));
}

#[test]
fn a_hash_is_written_in_two_digits_a_byte() {
    let mut campaign = in_memory(Vec::new());
    campaign.sha256 = std::array::from_fn(|index| index as u8);
    assert_eq!(campaign.hash(), "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f");
}

#[test]
fn a_model_may_name_as_many_channels_as_a_sample_holds() {
    let names: Vec<String> = (0..MAX_CHANNELS).map(|number| format!("c{number}_v")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let all = campaign(&format!("{HEAD},{}\n0,0,0,0{}\n", names.join(","), ",1".repeat(MAX_CHANNELS)));
    assert_eq!(all.arranged(&names).expect("all of them").channels, names);
    assert!(matches!(all.arranged(&[names[0]; MAX_CHANNELS + 1]), Err(CampaignError::TooManyChannels { .. })));
}

#[test]
fn minus_zero_is_the_same_reference_as_zero() {
    let reference = |text: &str| campaign(&format!("{HEAD}\n0,0,0,{text}\n")).runs[0].rows[0].reference_g.to_bits();
    assert_eq!((reference("-0"), reference("-0.0")), (0, 0));
}

/// What training says of two rows with these signals and references.
fn teaches(signals: [&str; 2], references: [f64; 2]) -> Result<(), CampaignError> {
    let rows = [0, 1].map(|row| format!("{row},{},{row},{:e}\n", signals[row], references[row])).concat();
    let demand = Demand { rows_min: 2, scale_factor_stated: false, one_run_will_do: true };
    campaign(&format!("{HEAD}\n{rows}")).check_trainable(&demand)
}

#[test]
fn a_signal_of_a_hundred_steps_can_teach() {
    assert_eq!(teaches(["0", "0.0001"], [0.0, 1.0]), Ok(()));
    assert!(matches!(teaches(["0", "0.000099"], [0.0, 1.0]), Err(CampaignError::TooCoarse(_))));
}

#[test]
fn a_reference_varies_by_more_than_a_billionth_of_itself() {
    let varies = |references: [f64; 2]| teaches(["0", "1"], references).is_ok();
    for unit in [1.0, 1e3, 1e-6, -1.0] {
        assert!(varies([unit, unit * (1.0 + 2e-9)]) && !varies([unit, unit * (1.0 + 5e-10)]), "{unit}");
        assert!(varies([-unit, unit]) && varies([unit / 2.0, unit]) && varies([0.0, unit]), "{unit}");
    }
    assert!(!varies([0.0, 0.0]));
}

#[test]
fn nothing_stands_for_no_column() {
    let folder = Folder::with(&[("run.csv", format!("{HEAD},\n0,1,2,3,4\n").as_bytes())]);
    assert!(matches!(folder.read(&mapped(&[("supply_v", " ")])), Err(CampaignError::BadMapping(_))));
}

#[test]
fn a_table_like_the_one_before_is_read_like_it_as_far_as_it_has_its_columns() {
    let before = ReadAs {
        options: mapped(&[("temperature_c", "Temp"), ("age_days", "7"), ("supply_v", "Supply*2")]),
        manifest: ReadOptions::default(),
    };
    let read = |content: &str| {
        let folder = Folder::with(&[("run.csv", content.as_bytes())]);
        let campaign = Campaign::read_like(&[folder.file("run.csv")], &ReadOptions::default(), &before);
        let campaign = campaign.unwrap_or_else(|error| panic!("{error}"));
        let sample = campaign.runs[0].rows[0].sample;
        (sample.temperature_uc, sample.age_s, campaign.channels)
    };
    let alike = read("time_s,delta_f_hz,Temp,reference_g,Supply\n0,1,20,0,3\n");
    assert_eq!(alike, (20_000_000, Some(7 * 86_400), vec!["supply_v".to_owned()]));
    let ordinary = read(&format!("{HEAD},age_days,supply_v\n0,1,25,0,1,3\n"));
    assert_eq!(ordinary, (25_000_000, Some(86_400), vec!["supply_v".to_owned()]), "its own columns come first");
    let bare = read(&format!("{HEAD}\n0,1,25,0\n"));
    assert_eq!(bare, (25_000_000, Some(7 * 86_400), Vec::new()), "what needs no column still holds");
}

#[test]
fn signal_reference_and_channels_of_the_table_before_give_way_where_they_are_not_there() {
    let text =
        "channels = ['a_v']\nconstant_reference = 0.5\n[columns]\na_v = 'A'\n[signal]\ncolumn = 'V'\nunit = 'mV'\n";
    let before = ReadAs { options: toml::from_str(text).expect("options"), ..ReadAs::default() };
    let read = |content: &str, before: &ReadAs| {
        let folder = Folder::with(&[("run.csv", content.as_bytes())]);
        let campaign = Campaign::read_like(&[folder.file("run.csv")], &ReadOptions::default(), before);
        let campaign = campaign.unwrap_or_else(|error| panic!("{error}"));
        (campaign.quantity.signal_unit.clone(), campaign.runs[0].rows[0].reference_g, campaign.channels)
    };
    let alike = read("time_s,V,temperature_c,A,b_v\n0,1,20,3,4\n", &before);
    assert_eq!(alike, ("mV".to_owned(), 0.5, vec!["a_v".to_owned()]), "one channel of two, by its mapping");
    let by_name = read("time_s,V,temperature_c,a_v,b_v\n0,1,20,3,4\n", &before);
    assert_eq!(by_name, ("mV".to_owned(), 0.5, vec!["a_v".to_owned()]), "or by its name");
    let other = read(&format!("{HEAD},b_v,c_v\n0,1,20,0.25,3,4\n"), &before);
    assert_eq!(other, ("Hz".to_owned(), 0.25, vec!["b_v".to_owned(), "c_v".to_owned()]), "nothing of it is there");
    let load = ReadAs {
        options: toml::from_str("[reference]\ncolumn = 'kg'\nunit = 'kg'\n").expect("options"),
        ..ReadAs::default()
    };
    assert_eq!(read("time_s,delta_f_hz,temperature_c,kg\n0,1,20,7\n", &load).1, 7.0);
    assert_eq!(read(&format!("{HEAD}\n0,1,20,0.25\n"), &load).1, 0.25);
}

#[test]
fn how_all_files_were_read_is_kept_where_they_agree() {
    let table = "clock,delta_f_hz,temperature_c,reference_g\n0,1,2,3\n".as_bytes();
    let (same, other) = ("[columns]\ntime_s = 'clock'\n", "[columns]\ntime_s = 'clock*2'\n");
    let folder = Folder::with(&[
        ("a/a.csv", table),
        ("a/campaign.toml", same.as_bytes()),
        ("b/b.csv", table),
        ("b/campaign.toml", same.as_bytes()),
        ("c/c.csv", table),
        ("c/campaign.toml", other.as_bytes()),
    ]);
    let given = ReadOptions { ignore: vec!["note".to_owned()], ..ReadOptions::default() };
    let read_as = |names: &[&str]| {
        let paths: Vec<PathBuf> = names.iter().map(|name| folder.file(name)).collect();
        Campaign::read(&paths, &given).unwrap_or_else(|error| panic!("{error}")).read_as
    };
    let agreed = ReadAs { options: given.clone(), manifest: toml::from_str(same).expect("options") };
    assert_eq!((read_as(&["a"]), read_as(&["a", "b"])), (agreed.clone(), agreed.clone()));
    assert_eq!(read_as(&["a", "c"]), ReadAs { manifest: ReadOptions::default(), ..agreed });
}

#[test]
fn a_difference_beside_two_frequencies_agrees_as_far_as_the_digits_of_all_three_tell() {
    let read = |difference: &str| {
        let table = format!("time_s,f1_hz,f2_hz,delta_f_hz,temperature_c,reference_g\n0,10,4,{difference},25,0\n");
        let folder = Folder::with(&[("run.csv", table.as_bytes())]);
        folder.read(&ReadOptions::default()).map(|campaign| campaign.runs[0].rows[0].sample.delta_f_uhz)
    };
    // Half a hertz for each of the two, and half of the last digit of the third.
    assert_eq!((read("6.9"), read("5.0"), read("7.0")), (Ok(6_000_000), Ok(6_000_000), Ok(6_000_000)));
    assert!(["7.1", "4.9"].iter().all(|&text| matches!(read(text), Err(CampaignError::Disagreement(_)))));
}

#[test]
fn a_table_may_be_as_wide_and_a_name_as_long_as_is_said() {
    let long = "n".repeat(MAX_NAME);
    let texts: String = (5..=MAX_COLUMNS - 1).map(|number| format!(",t{number}")).collect();
    let wide = campaign(&format!("run,{HEAD}{texts}\n{long},0,1,2,3{}\n", ",x".repeat(MAX_COLUMNS - 5)));
    assert_eq!((wide.runs[0].name.as_str(), wide.ignored_columns.len()), (long.as_str(), MAX_COLUMNS - 5));
    assert_eq!(campaign(&format!("{HEAD},{long}\n0,1,2,3,4\n")).channels, [long]);
}

#[test]
fn what_stands_in_quotes_separates_nothing() {
    let read = campaign("\"a, b, c, d, e, f, g\";time_s;delta_f_hz;temperature_c;reference_g\nx;1;2;3;4\n");
    assert_eq!(read.ignored_columns, ["a, b, c, d, e, f, g"]);
    assert_eq!(read.runs[0].rows[0].reference_g, 4.0);
}

#[test]
fn a_table_whose_lines_end_in_a_return_alone_is_refused_in_the_right_line() {
    for end in ["\n", "\r\n", "\r"] {
        let table = [HEAD, "0,1,2,3", "1,x,2,3", "2,1,2,3", ""].join(end);
        let folder = Folder::with(&[("run.csv", table.as_bytes())]);
        let refused = folder.read(&ReadOptions::default()).expect_err("no number");
        assert!(refused.to_string().contains("run.csv:3, column 2"), "{end:?}: {refused}");
    }
}

#[test]
fn a_number_in_place_of_a_column_is_the_same_in_every_row() {
    let campaign = campaign_of("time_s,delta_f_hz,reference_g\n0,1,0\n1,1,0\n", &mapped(&[("temperature_c", "21.5")]));
    assert!(campaign.rows().all(|row| row.sample.temperature_uc == 21_500_000));
}
