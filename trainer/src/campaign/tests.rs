//! Reading ordinary and foreign tables.

use super::*;
use protocol::Sample;
use protocol::Status;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::fmt::Write;
use std::path::Path;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

/// Files in a folder of their own, which vanishes with this value.
pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn with(files: &[(&str, &[u8])]) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let folder = Self(std::env::temp_dir().join(format!("tempco-campaign-{}-{number}", std::process::id())));
        std::fs::create_dir_all(&folder.0).expect("a folder");
        for (name, content) in files {
            let path = folder.file(name);
            std::fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
            std::fs::write(path, content).expect("a file");
        }
        folder
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(super) fn read(&self, options: &ReadOptions) -> Result<Campaign, CampaignError> {
        Campaign::read(std::slice::from_ref(&self.0), options)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Options of `--map` alone.
pub(super) fn mapped(map: &[(&str, &str)]) -> ReadOptions {
    let owned = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
    ReadOptions { map: map.iter().map(owned).collect(), ..ReadOptions::default() }
}

/// These channels were measured and no others.
fn channels(measured: &[i64]) -> [i64; MAX_CHANNELS] {
    std::array::from_fn(|channel| measured.get(channel).copied().unwrap_or(Sample::NOT_MEASURED))
}

pub(super) fn campaign(content: &str) -> Campaign {
    campaign_of(content, &ReadOptions::default())
}

pub(super) fn campaign_of(content: &str, options: &ReadOptions) -> Campaign {
    let folder = Folder::with(&[("run-01.csv", content.as_bytes())]);
    folder.read(options).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_column_of_the_contract_is_read() {
    let campaign = campaign(
        "run,kind,time_s,power_on_s,age_days,delta_f_hz,sum_f_hz,temperature_c,reference_g,reference_sigma_g,supply_v\n\
         a,Ramp,0.5,12.25,1.5,76000.000001,82400.5,-40.125,-0.999,0.000002,3.3\n",
    );
    let [run] = campaign.runs.as_slice() else { panic!("one run") };
    assert_eq!((run.name.as_str(), run.kind.as_str()), ("a", "ramp"));
    assert!(run.source.ends_with("run-01.csv"));
    assert_eq!(campaign.channels, ["supply_v"]);
    let sample = Sample {
        time_us: 500_000,
        power_on_us: 12_250_000,
        age_s: Some(129_600),
        delta_f_uhz: 76_000_000_001,
        sum_f_uhz: Some(82_400_500_000),
        temperature_uc: -40_125_000,
        channels: channels(&[3_300_000]),
        faults: Status::empty(),
    };
    assert_eq!(run.rows, [Row { sample, reference_g: -0.999, reference_sigma_g: Some(2e-6) }]);
}

#[test]
fn the_required_columns_are_enough() {
    let campaign = campaign("time_s,delta_f_hz,temperature_c,reference_g\n1,2,3,4\n");
    let run = &campaign.runs[0];
    assert_eq!((run.name.as_str(), run.kind.as_str()), ("run-01", UNSTATED));
    let expected = Sample::from_difference(1_000_000, 2_000_000, 3_000_000);
    assert_eq!(run.rows, [Row { sample: expected, reference_g: 4.0, reference_sigma_g: None }]);
    assert_eq!(campaign.quantity, Quantity { signal_unit: "Hz".into(), reference_unit: "g".into() });
}

#[test]
fn the_form_of_the_file_changes_nothing() {
    let plain = "time_s,delta_f_hz,temperature_c,reference_g,note\n0,1.5,25,-1,x\n1,2.5,26,1,y\n";
    let expected = campaign(plain);
    assert_eq!(expected.ignored_columns, ["note"]);
    for form in [
        "time_s;delta_f_hz;temperature_c;reference_g;note\n0;1.5;25;-1;a,b\n1;2.5;26;1;c,d,e,f,g\n",
        "time_s\tdelta_f_hz\ttemperature_c\treference_g\tnote\n0\t1.5\t25\t-1\tx\n1\t2.5\t26\t1\ty",
        "\u{feff}time_s,delta_f_hz,temperature_c,reference_g,note\r\n0,1.5,25,-1,x\r\n1,2.5,26,1,y\r\n",
        "# a, b; c; d; e; f\n\n# more\n\"time_s\", \"delta_f_hz\" ,temperature_c,reference_g,\"note\"\n\n 0 , 1.5 ,25,-1,\"x, y\"\n#\n1,\"2.5\",26,1,y\n,,,,\n",
        "note,reference_g,temperature_c,delta_f_hz,time_s\nx,-1.0,25.000,15e-1,0e0\ny,+1,26,2.50,1.0\n",
    ] {
        let read = campaign(form);
        assert_eq!((&read.runs[0].rows, read.sha256), (&expected.runs[0].rows, expected.sha256), "{form}");
    }
}

#[test]
fn the_hash_knows_the_content_and_nothing_else() {
    let header = "time_s,delta_f_hz,temperature_c,reference_g";
    let hash = |content: &str| campaign(content).sha256;
    let original = hash(&format!("{header},a_v,b_v\n0,1,2,3,4,5\n"));
    assert_eq!(original, hash(&format!("b_v,a_v,{header}\n5,4,0,1,2,3\n")));
    for other in [
        format!("{header},b_v,a_v\n0,1,2,3,4,5\n"),
        format!("{header},a_v,b_v\n0,1,2,3,4,5.000001\n"),
        format!("{header},a_v,b_v,run\n0,1,2,3,4,5,another\n"),
        format!("{header},a_v,b_v,kind\n0,1,2,3,4,5,ramp\n"),
        format!("{header},a_v,b_v,power_on_s\n0,1,2,3,4,5,6\n"),
        format!("{header},a_v,b_v,age_days\n0,1,2,3,4,5,6\n"),
        format!("{header},a_v,b_v,sum_f_hz\n0,1,2,3,4,5,6\n"),
        format!("{header},a_v,b_v,reference_sigma_g\n0,1,2,3,4,5,6\n"),
    ] {
        assert_ne!(original, hash(&other), "{other}");
    }
    let named = |run: &str, kind: &str| hash(&format!("run,kind,{header}\n{run},{kind},0,1,2,3\n"));
    assert_ne!(named("ab", "c"), named("a", "bc"), "where one name ends and the next begins");
}

#[test]
fn two_frequencies_make_difference_and_sum() {
    let pair = "time_s,f1_hz,f2_hz,temperature_c,reference_g";
    let uhz = |campaign: Campaign| {
        let sample = campaign.runs[0].rows[0].sample;
        (sample.delta_f_uhz, sample.sum_f_uhz)
    };
    let expected = (76_000_000_001, Some(82_400_000_000_001));
    let (f1, f2) = ("41238000.000001", "41162000");
    assert_eq!(uhz(campaign(&format!("{pair}\n0,{f1},{f2},25,1\n"))), expected);
    let both = format!("{pair},delta_f_hz,sum_f_hz\n0,{f1},{f2},25,1,76000.0000,82400000.000\n");
    assert_eq!(uhz(campaign(&both)), expected, "what stands beside the pair may have fewer digits");
}

#[test]
fn runs_may_be_interleaved() {
    let campaign = campaign(
        "run,kind,time_s,delta_f_hz,temperature_c,reference_g\n\
         b,full,5,0,0,0\na,,1,0,0,0\nb,FULL,6,0,0,0\na,,2,0,0,0\nb,full,9,0,0,0\n",
    );
    let runs: Vec<_> = campaign.runs.iter().map(|run| (run.name.as_str(), run.kind.as_str(), run.rows.len())).collect();
    assert_eq!(runs, [("b", "full", 3), ("a", UNSTATED, 2)]);
}

#[test]
fn a_folder_is_read_in_the_order_of_its_names() {
    let row = "time_s,delta_f_hz,temperature_c,reference_g,x_v,y_v\n0,0,0,0,1,2\n".as_bytes();
    let turned = "time_s,delta_f_hz,temperature_c,reference_g,y_v,x_v\n0,0,0,0,2,1\n".as_bytes();
    let folder =
        Folder::with(&[("b.csv", turned), ("a.CSV", row), (".c.csv", b"?"), ("notes.md", b"?"), ("d/e.csv", row)]);
    let campaign = folder.read(&ReadOptions::default()).expect("a campaign");
    let names: Vec<&str> = campaign.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!((names, campaign.channels.clone()), (vec!["a", "b"], vec!["x_v".to_owned(), "y_v".to_owned()]));
    assert_eq!(campaign.runs[0].rows, campaign.runs[1].rows);
}

#[test]
fn files_of_one_name_are_told_apart_by_their_folder() {
    let row = b"time_s,delta_f_hz,temperature_c,reference_g\n0,0,0,0\n";
    let folder = Folder::with(&[("day-1/log.csv", row), ("day-2/log.csv", row)]);
    let paths = ["day-1", "day-2"].map(|name| folder.file(name));
    let campaign = Campaign::read(&paths, &ReadOptions::default()).expect("a campaign");
    let names: Vec<&str> = campaign.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(names, ["day-1/log", "day-2/log"]);
}

#[test]
fn a_foreign_log_is_mapped() {
    let log = "timestamp [ns]\timu.gyro.x\timu.acc.z\timu.status\timu.temperature\n\
               256551281491968\t-0.04710827768\t-9.55327034\t0\t51.61518097\n\
               256551281997598\t-0.07069627941\t-9.686152458\t0\t52.10612869\n";
    let options = ReadOptions {
        map: mapped(&[("time_s", "timestamp [ns] * 1e-9 - 256551"), ("temperature_c", "imu.temperature")]).map,
        signal: Some(Measured { column: "imu.acc.z".into(), unit: "m/s²".into() }),
        ignore: vec!["imu.status".into()],
        constant_reference: Some(-1.0),
        ..ReadOptions::default()
    };
    let campaign = campaign_of(log, &options);
    let first = &campaign.runs[0].rows[0];
    assert_eq!(
        (first.sample.time_us, first.sample.delta_f_uhz, first.sample.temperature_uc),
        (281_492, -9_553_270, 51_615_181)
    );
    assert_eq!((first.sample.channels[0], first.reference_g), (-47_108, -1.0));
    assert_eq!((campaign.channels, campaign.ignored_columns), (vec!["imu.gyro.x".into()], vec!["imu.status".into()]));
    assert_eq!(campaign.quantity, Quantity { signal_unit: "m/s²".into(), reference_unit: "g".into() });
}

#[test]
fn a_manifest_beside_the_data_does_the_same() {
    let log = b"\"Load, lb\",mV/V,Vdd_mV,RH,operator\n100,0.20024,3300,41,Ann\n200,0.40056,3301,42,Bob\n";
    let manifest = b"channels = [\"supply_v\"]\n\
        [columns]\ntime_s = \"row*0.5+1\"\ntemperature_c = \"21.5\"\nsupply_v = \"Vdd_mV/1000\"\n\
        [signal]\ncolumn = \"mV/V*1e3\"\nunit = \"uV/V\"\n\
        [reference]\ncolumn = \"Load, lb*0.45359237\"\nunit = \"kg\"\n";
    let folder = Folder::with(&[("cell.csv", log), ("campaign.toml", manifest)]);
    let campaign = Campaign::read(&[folder.file("cell.csv")], &mapped(&[("temperature_c", "22")])).expect("a campaign");
    let second = &campaign.runs[0].rows[1];
    assert_eq!(
        second.sample,
        Sample { channels: channels(&[3_301_000]), ..Sample::from_difference(1_500_000, 400_560_000, 22_000_000) }
    );
    assert_eq!(second.reference_g, 90.718474);
    assert_eq!(campaign.quantity, Quantity { signal_unit: "uV/V".into(), reference_unit: "kg".into() });
    assert_eq!(campaign.ignored_columns, ["RH", "operator"]);
}

#[test]
fn a_column_can_serve_twice_and_a_map_hides_the_column_of_its_name() {
    let options = mapped(&[("time_s", "t"), ("power_on_s", "t+100"), ("reference_g", "true_g")]);
    let campaign = campaign_of("t,delta_f_hz,temperature_c,reference_g,true_g\n1,2,3,4,5\n", &options);
    let row = &campaign.runs[0].rows[0];
    assert_eq!((row.sample.time_us, row.sample.power_on_us, row.reference_g), (1_000_000, 101_000_000, 5.0));
    assert_eq!(campaign.ignored_columns, ["reference_g"]);
}

#[test]
fn channels_are_arranged_for_a_model() {
    let campaign = campaign("time_s,delta_f_hz,temperature_c,reference_g,a_v,b_v,c_v\n0,0,0,0,1,2,3\n");
    let arranged = campaign.arranged(&["c_v", "a_v"]).expect("both are there");
    assert_eq!(arranged.channels, ["c_v", "a_v"]);
    assert_eq!(arranged.runs[0].rows[0].sample.channels, channels(&[3_000_000, 1_000_000]));
    assert_eq!(arranged.sha256, campaign.sha256);
}

#[test]
fn a_calendars_clock_is_no_time_since_power_on() {
    let rows = |power_on: &str, epoch: f64| {
        let head = "run,time_s,delta_f_hz,temperature_c,reference_g";
        let row = |run: &str, s: f64| format!("{run},{},0,0,0{}\n", epoch + s, power_on.replace("POWER_ON_S", ",5"));
        let column = power_on.replace("POWER_ON_S", ",power_on_s");
        campaign(&format!("{head}{column}\n{}{}{}{}", row("a", 2.0), row("b", 100.0), row("a", 9.0), row("b", 130.0)))
    };
    let power_on_s =
        |campaign: &Campaign| -> Vec<f64> { campaign.rows().map(|row| row.sample.power_on_us as f64 * 1e-6).collect() };
    for epoch in [1.7e9, 3.8e9, 1.7e12] {
        let calendar = rows("", epoch);
        assert_eq!(power_on_s(&calendar), [0.0, 7.0, 0.0, 30.0], "each run from its first row");
        assert!(calendar.runs.iter().all(|run| run.has_calendar_time() && run.begins_with_power_on()));
        assert_eq!(power_on_s(&rows("POWER_ON_S", epoch)), [5.0; 4], "a stated time stands");
    }
    for start in [0.0, 86_400.0, 1e8] {
        let uptime = rows("", start);
        let expected = [2.0, 9.0, 100.0, 130.0].map(|s| start + s);
        assert_eq!(power_on_s(&uptime), expected, "one clock goes on from run to run");
        assert!(!uptime.runs[0].has_calendar_time());
    }
}

#[test]
fn runs_and_campaigns_measure_themselves() {
    let campaign =
        campaign("time_s,delta_f_hz,temperature_c,reference_g\n0,0,0,-1\n1,0,0,0\n2,0,0,1.25\n4,0,0,1\n10,0,0,-1\n");
    let run = &campaign.runs[0];
    assert_eq!((run.duration_s(), run.sample_interval_s()), (10.0, Some(2.0)));
    assert_eq!((campaign.row_count(), campaign.rows().count()), (5, 5));
    assert_eq!(campaign.levels(0.3), [-1.0, 0.0, 1.125]);
    assert_eq!((run.between(1_000_000, 4_000_000).len(), run.between(9, 3).len()), (2, 0));
}

#[test]
fn what_is_written_is_read_again() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    for _ in 0..20 {
        let original = random_campaign(&mut random);
        let read = campaign(&written(&original));
        assert_eq!((read.sha256, &read.channels), (original.sha256, &original.channels));
        for (read, original) in read.runs.iter().zip(&original.runs) {
            assert_eq!((&read.name, &read.kind, &read.rows), (&original.name, &original.kind, &original.rows));
        }
    }
}

#[test]
fn a_spoilt_file_is_read_or_refused_in_its_place() {
    const SPOILT: [&str; 16] =
        [",", ";", "\t", "\"", "\n", "\r", "#", "e", "-", ".", "9999999999", "°", "\0", "e30", "e-400", "\u{feff}"];
    let mut random = Xoshiro256PlusPlus::seed_from_u64(8);
    let mut pick = |from: usize| (random.next_u64() % from as u64) as usize;
    let intact = "run,time_s,f1_hz,f2_hz,temperature_c,reference_g,x_v\na,0,2,1,25,1,5\n# x\na,1,2.5,1,25,1e0,5\n";
    for _ in 0..300 {
        let mut text = intact.to_owned();
        for _ in 0..1 + pick(3) {
            let starts: Vec<usize> = text.char_indices().map(|(start, _)| start).collect();
            text.insert_str(starts[pick(starts.len())], SPOILT[pick(SPOILT.len())]);
        }
        let folder = Folder::with(&[("run.csv", text.as_bytes())]);
        if let Err(error) = folder.read(&ReadOptions::default()) {
            let place = &error.facts().place;
            assert!(place.line.is_some_and(|line| line <= text.split(['\n', '\r']).count() as u64), "{error}\n{text}");
            assert!(!error.help().is_empty());
        }
    }
}

/// A campaign of random integers of any size that the columns can hold.
fn random_campaign(random: &mut Xoshiro256PlusPlus) -> Campaign {
    let channels: Vec<String> = (0..random.next_u64() % 9).map(|number| format!("channel_{number}")).collect();
    let runs = (0..1 + random.next_u64() % 4).map(|number| {
        let (mut time_us, kind) = (0, ["ramp", "full", "a, \"b\""][(random.next_u64() % 3) as usize]);
        let rows = (0..1 + random.next_u64() % 50).map(|_| {
            time_us += 1 + (random.next_u64() >> (40 + random.next_u64() % 24));
            random_row(random, time_us, channels.len())
        });
        let rows = rows.collect();
        Run { name: format!("run-{number}"), kind: kind.to_owned(), source: PathBuf::new(), rows }
    });
    let runs = runs.collect();
    Campaign::new(runs, channels, Quantity::default())
}

fn random_row(random: &mut Xoshiro256PlusPlus, time_us: u64, channels: usize) -> Row {
    let mut sample =
        Sample::from_difference(time_us, random.next_u64().cast_signed() >> 3, random.next_u32().cast_signed());
    sample.power_on_us = random.next_u64() >> 1;
    sample.sum_f_uhz = Some(random.next_u64() >> 1);
    for channel in sample.channels.iter_mut().take(channels) {
        *channel = random.next_u64().cast_signed();
    }
    let reference_g = (random.next_u64() >> 11) as f64 * 2e-16 - 1.0;
    Row { sample, reference_g, reference_sigma_g: Some(reference_g.abs() * 1e-6) }
}

/// The campaign as text, in exact decimals.
fn written(campaign: &Campaign) -> String {
    let text = number::micro_text;
    let mut csv =
        "run,kind,time_s,power_on_s,delta_f_hz,sum_f_hz,temperature_c,reference_g,reference_sigma_g".to_owned();
    for channel in &campaign.channels {
        let _ = write!(csv, ",{channel}");
    }
    for (run, row) in campaign.runs.iter().flat_map(|run| run.rows.iter().map(move |row| (run, row))) {
        let Row { sample, reference_g, reference_sigma_g } = row;
        let _ = write!(csv, "\n{},\"{}\"", run.name, run.kind.replace('"', "\"\""));
        let integers: [i128; 5] = [
            sample.time_us.into(),
            sample.power_on_us.into(),
            sample.delta_f_uhz.into(),
            sample.sum_f_uhz.unwrap_or_default().into(),
            sample.temperature_uc.into(),
        ];
        for integer in integers {
            let _ = write!(csv, ",{}", text(integer));
        }
        let _ = write!(csv, ",{reference_g},{}", reference_sigma_g.unwrap_or_default());
        for &channel in sample.channels.iter().take(campaign.channels.len()) {
            let _ = write!(csv, ",{}", text(channel.into()));
        }
    }
    csv
}
