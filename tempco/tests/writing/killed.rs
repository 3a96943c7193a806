//! Whoever is killed at a random moment leaves the old file or the new one, and nothing else: every verb that writes. No call
//! of the system puts a file without a name over an older one; killed between the two calls that do, a command leaves the
//! whole new file beside the old one, until the next command that writes there.

use super::folder::{SMALL_SCENARIO, TEMPCO, WRITERS, contents, said, worked_in, writing};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Pseudorandom numbers, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

/// A command and what it writes.
struct Case<'a> {
    arguments: Vec<&'a str>,
    files: &'a [&'a str],
    /// What it writes is another thing each time, and never over an older one.
    is_new_each_time: bool,
}

impl<'a> Case<'a> {
    fn new(arguments: &[&'a str], files: &'a [&'a str]) -> Self {
        Self { arguments: arguments.to_vec(), files, is_new_each_time: false }
    }

    /// One of [`WRITERS`].
    fn of(writer: usize, files: &'a [&'a str]) -> Self {
        Self::new(&writing(WRITERS[writer], files[0]), files)
    }
}

/// What takes seconds.
fn quick(port: &str) -> Vec<Case<'_>> {
    let mut again = Case::of(0, &["model.toml"]);
    again.arguments.extend(["--seed", "2"]);
    let keys = Case::new(&["device", "keygen", "-o", "other"], &["other.key", "other.pub"]);
    let figures: &[&str] =
        &["figures/figure-3-schaffer.svg", "figures/figure-4-rastrigin.svg", "figures/success-rates.svg"];
    let effects = "thermal-lag,thermal-gradient";
    vec![
        again,
        Case::of(1, &["added.toml"]),
        Case::new(&["remove", "with.toml", "warm-up", "small.csv", "-o", "without.toml"], &["without.toml"]),
        Case::of(3, &["calibration.bin"]),
        Case::of(3, &["calibration.hex"]),
        Case::of(4, &["signed.bin"]),
        Case::of(5, &["report.html"]),
        Case::of(6, &["sim.csv"]),
        Case::of(7, &["campaign.csv", "campaign.sealed"]),
        Case::of(8, &["identity.hex"]),
        Case { is_new_each_time: true, ..keys },
        Case::new(&["device", "read", port, "-o", "read.bin"], &["read.bin"]),
        Case::new(&["plan", "model.toml", "small.csv", "--effects", effects, "-o", "next"], &["next/fast-ramp.toml"]),
        Case::new(&["reproduce", "--figures", "--seeds", "2", "-o", "figures"], figures),
    ]
}

const DEMO: [&str; 6] = [
    "demo/campaign.csv",
    "demo/campaign.sealed",
    "demo/model.toml",
    "demo/better.toml",
    "demo/calibration.bin",
    "demo/calibration.hex",
];
const TABLES: [&str; 4] =
    ["tables/seed.csv", "tables/seed-a1.csv", "tables/seed-a2.csv", "tables/between-the-levels.svg"];

/// What takes long.
fn slow() -> Vec<Case<'static>> {
    let tables = ["reproduce", "--tables", "--restarts", "1", "--passes", "5", "-o", "tables"];
    vec![Case::new(&["demo", "-o", "demo"], &DEMO), Case::new(&tables, &TABLES)]
}

/// Starts a command, ends it after a while with Ctrl-C or the harder way, and says whether it was ended before it was done.
fn is_killed(folder: &Path, arguments: &[&str], random: &mut Random, took_us: u64) -> bool {
    let mut process = Command::new(TEMPCO)
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    std::thread::sleep(Duration::from_micros(random.below(took_us * 11 / 10)));
    let signal = if random.below(2) == 0 { "-INT" } else { "-KILL" };
    let id = process.id().to_string();
    drop(Command::new("kill").args([signal, &id]).stderr(Stdio::null()).status());
    !process.wait().expect("it ends").success()
}

/// Puts files back as they were.
fn restore(folder: &Path, files: &[&str], from: &BTreeMap<String, Vec<u8>>) {
    for file in files {
        match from.get(*file) {
            Some(bytes) => fs::write(folder.join(file), bytes).expect("written"),
            None => drop(fs::remove_file(folder.join(file))),
        }
    }
}

/// What was there before, and what a command makes of it in so many µs.
struct States {
    old: BTreeMap<String, Vec<u8>>,
    new: BTreeMap<String, Vec<u8>>,
    took_us: u64,
}

impl States {
    #[expect(clippy::disallowed_methods, reason = "when to kill takes a clock")]
    fn of(folder: &Path, case: &Case) -> Self {
        let old = contents(folder);
        let start = std::time::Instant::now();
        said(folder, 0, &case.arguments);
        Self { old, took_us: start.elapsed().as_micros() as u64, new: contents(folder) }
    }
}

/// Kills a command so often; how many of them were not done before.
fn killed(folder: &Path, case: &Case, kills: usize, random: &mut Random) -> usize {
    let states = States::of(folder, case);
    let others = |all: &BTreeMap<String, Vec<u8>>| -> BTreeSet<String> {
        all.keys().filter(|name| !case.files.contains(&name.as_str())).cloned().collect()
    };
    assert!(
        case.files.iter().all(|file| states.new.contains_key(*file)),
        "{:?}: {:?}",
        case.arguments,
        others(&states.new)
    );
    let mut count = 0;
    for attempt in 0..kills {
        let before = if attempt % 2 == 0 || case.is_new_each_time { &states.old } else { &states.new };
        restore(folder, case.files, before);
        count += usize::from(is_killed(folder, &case.arguments, random, states.took_us));
        let after = contents(folder);
        for file in case.files {
            let found = after.get(*file);
            let is_new = if case.is_new_each_time {
                found.is_some_and(|key| is_key(key))
            } else {
                found == states.new.get(*file)
            };
            assert!(found == before.get(*file) || is_new, "{file} is cut after kill {attempt} of {:?}", case.arguments);
        }
        let left: Vec<String> = others(&after).difference(&others(&states.old)).cloned().collect();
        for name in &left {
            let is_whole = states.new.values().any(|bytes| after.get(name) == Some(bytes));
            assert!(name.ends_with(".part") && is_whole, "{name} is left behind by {:?}", case.arguments);
            println!("killed between two calls of the system: {name} of {:?}", case.arguments);
        }
    }
    if case.is_new_each_time {
        restore(folder, case.files, &states.old);
    }
    said(folder, 0, &case.arguments);
    assert_eq!(others(&contents(folder)), others(&states.old), "something is left behind by {:?}", case.arguments);
    count
}

/// Whether it is a whole key: 64 hexadecimal digits in its last line.
fn is_key(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    text.ends_with('\n')
        && text.lines().last().is_some_and(|line| line.len() == 64 && line.bytes().all(|b| b.is_ascii_hexdigit()))
}

/// A virtual instrument that holds the model's calibration; dropping it switches it off.
struct Served {
    process: Child,
    port: String,
}

impl Served {
    fn start(folder: &Path) -> Self {
        let mut process = Command::new(TEMPCO)
            .current_dir(folder)
            .args(["device", "serve", "--scenario", SMALL_SCENARIO, "--serial", "SN-1", "--tcp", "127.0.0.1:0"])
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("piped")).read_line(&mut line).expect("a line");
        let port = line.strip_prefix("Instrument SN-1 at ").and_then(|rest| rest.split(';').next());
        let served = Self { port: port.unwrap_or_else(|| panic!("{line}")).to_owned(), process };
        said(folder, 0, &["flash", "model.toml", "--to", &served.port]);
        served
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        drop(self.process.kill());
        drop(self.process.wait());
    }
}

/// 100 by default; `TEMPCO_KILLS=500` kills more often, and what takes long too.
#[test]
fn whoever_is_killed_leaves_the_old_file_or_the_new_one_and_nothing_else() {
    let kills: usize = std::env::var("TEMPCO_KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(100);
    let folder = worked_in();
    let folder = folder.path();
    let served = Served::start(folder);
    said(folder, 0, &["add", "model.toml", "warm-up", "small.csv", "-o", "with.toml"]);
    let (quick, mut random) = (quick(&served.port), Random(7));
    let mut count = 0;
    for case in &quick {
        count += killed(folder, case, kills.div_ceil(quick.len()), &mut random);
    }
    if kills >= MANY {
        count += slow().iter().map(|case| killed(folder, case, kills / MANY * SLOW_KILLS, &mut random)).sum::<usize>();
    }
    println!("{count} killed before they were done");
    assert!(count > kills / 3, "only {count} of {kills} were killed");
}

const MANY: usize = 500;
const SLOW_KILLS: usize = 12;
