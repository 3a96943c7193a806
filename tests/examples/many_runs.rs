//! How much memory and time a campaign of very many runs takes: `cargo run --release -p tests --example many_runs -- 3000 100`.

use protocol::Sample;
use std::path::PathBuf;
use std::time::Instant;
use trainer::campaign::{Campaign, HoldOut, Quantity, Row, Run};
use trainer::diagnose::diagnose;
use trainer::progress::Quiet;
use trainer::train::{TrainSettings, train};

/// A resonant accelerometer of 420 Hz/g with a lag of 45 s, noise of 5 µg and run offsets of a few µg.
fn run(number: u64, rows: u64) -> Run {
    let mut state = number.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut normal = move || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        (0..12).map(|_| uniform()).sum::<f64>()
    };
    let (offset_g, mut inside_c) = (3e-6 * normal(), -20.0 + 80.0 * (number % 37) as f64 / 37.0);
    let rate_c_per_s = if number.is_multiple_of(2) { 1.0 } else { -1.0 } / 60.0;
    let mut outside_c = inside_c;
    let row = |k: u64| {
        outside_c += 10.0 * rate_c_per_s;
        inside_c += (outside_c - inside_c) * (1.0 - f64::exp(-10.0 / 45.0));
        let level_g = f64::sin((k / 12 + number) as f64 * std::f64::consts::FRAC_PI_4);
        let warm_c = inside_c - 20.0;
        let read_g = level_g + offset_g + 5e-6 * normal() + 900e-6 * warm_c + 3e-6 * warm_c * warm_c;
        let delta_f_hz = 76.0 + 420.0 * read_g;
        let sample = Sample::from_difference(k * 10_000_000, (delta_f_hz * 1e6) as i64, (outside_c * 1e6) as i32);
        Row { sample, reference_g: level_g, reference_sigma_g: None }
    };
    Run {
        name: format!("r{number}"),
        kind: "ramp".to_owned(),
        source: PathBuf::new(),
        rows: (0..rows).map(row).collect(),
    }
}

/// Most memory that this process ever had, MiB.
fn peak_mib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kib| kib.parse::<u64>().ok()).unwrap_or_default() / 1024
}

#[expect(clippy::disallowed_methods, reason = "how long it takes is what is asked")]
fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|text| text.parse::<u64>().ok());
    let (runs, rows) = (numbers.next().unwrap_or(3000), numbers.next().unwrap_or(100));
    let campaign = Campaign::new((0..runs).map(|number| run(number, rows)).collect(), Vec::new(), Quantity::default());
    let start = Instant::now();
    let told = |what: &str| println!("{what}: {:.0} s, {} MiB at most", start.elapsed().as_secs_f64(), peak_mib());
    told("campaign");
    let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let settings = TrainSettings { restarts: 4, ..TrainSettings::new(1) };
    let model = train(&campaign, &split, &settings, &Quiet).expect("a model").model;
    told("train");
    let diagnosis = diagnose(&model, &campaign, &Quiet).expect("a diagnosis");
    told("diagnose");
    let names: Vec<&str> = diagnosis.findings.iter().map(|finding| finding.effect.as_str()).collect();
    println!("{:?} {names:?}, {:.1} ug of noise", diagnosis.verdict, diagnosis.noise_floor_ug);
}
