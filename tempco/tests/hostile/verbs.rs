//! Every verb over one case, each bounded in time and memory.

use super::campaign::Spoilt;
use super::model;
use super::random::Random;
use std::fmt;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// What became of the cases.
#[derive(Default)]
pub struct Tally {
    pub commands: u64,
    pub refused: u64,
    pub trained: u64,
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { commands, refused, trained } = self;
        write!(f, "{trained} could be trained on; {commands} commands, {refused} of them refused with a sentence")
    }
}

/// The campaigns have at most some thousand rows: what takes longer or more is no answer.
const SECONDS: &str = "60";
const KIBIBYTES: &str = "3000000";

const EFFECTS: [&str; 12] = [
    "thermal-lag",
    "thermal-gradient",
    "warm-up",
    "thermal-hysteresis",
    "second-order",
    "supply-voltage",
    "cross-axis",
    "aging",
    "mode-crossing",
    "lock-in",
    "g-hysteresis",
    "turn-on",
];

/// Takes the verbs over a case and says what was wrong.
pub fn chain(folder: &Path, case: &Spoilt, random: &mut Random, tally: &mut Tally) -> Vec<String> {
    fs::write(folder.join("c.csv"), &case.bytes).expect("writable");
    let mut faults = Vec::new();
    let mut run = |words: &[&str], options: &[&[String]]| {
        let words: Vec<&str> =
            words.iter().copied().chain(options.iter().copied().flatten().map(String::as_str)).collect();
        let (code, told) = bounded(folder, &words);
        tally.commands += 1;
        tally.refused += u64::from(code == 2);
        let panicked = told.contains("panicked") || told.contains("RUST_BACKTRACE");
        let no_number = code != 2 && told.contains("NaN");
        let silent = code == 2 && !told.contains("error: ");
        if !(0..=2).contains(&code) || panicked || silent || no_number {
            faults.push(format!("tempco {}: exit code {code}: {}", words.join(" "), told.trim()));
        }
        code
    };
    let read = [case.options.as_slice()];
    run(&["inspect", "c.csv"], &read);
    let trained = run(&["train", "c.csv", "-o", "m.toml", "--restarts", "1"], &[&case.options, &case.training]);
    let model = fs::read_to_string(folder.join("m.toml"));
    if let (0, Ok(text)) = (trained, model) {
        tally.trained += 1;
        let effect = random.of(&EFFECTS);
        run(&["compare", "m.toml", "c.csv", "--json"], &read);
        run(&["compare", "m.toml", "c.csv", "--report", "r.html"], &read);
        run(&["diagnose", "m.toml", "c.csv"], &read);
        run(&["plan", "m.toml", "c.csv"], &read);
        run(&["verify", "m.toml", "c.csv"], &read);
        run(&["export", "m.toml", "-o", "b.hex"], &[]);
        if run(&["add", "m.toml", effect, "c.csv", "-o", "a.toml"], &read) == 0 {
            run(&["diagnose", "a.toml", "c.csv", "--json"], &read);
            run(&["remove", "a.toml", effect, "c.csv", "-o", "x.toml"], &read);
        }
        fs::write(folder.join("s.toml"), model::spoilt(&text, random)).expect("writable");
        run(&["export", "s.toml", "-o", "s.bin"], &[]);
        run(&["compare", "s.toml", "c.csv"], &read);
    }
    faults
}

fn bounded(folder: &Path, words: &[&str]) -> (i32, String) {
    let output = Command::new("sh")
        .args(["-c", "ulimit -v \"$1\"; shift; exec timeout \"$@\"", "sh", KIBIBYTES, SECONDS])
        .arg(env!("CARGO_BIN_EXE_tempco"))
        .args(words)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    let told = String::from_utf8_lossy(&output.stderr).into_owned() + &printed_nan(&output.stdout);
    (output.status.code().unwrap_or(-1), told)
}

/// A figure that is none would be printed as an answer.
fn printed_nan(stdout: &[u8]) -> String {
    let text = String::from_utf8_lossy(stdout);
    text.lines().filter(|line| line.contains("NaN")).take(1).map(str::to_owned).collect()
}
