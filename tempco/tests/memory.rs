//! Claim: the memory of a diagnosis grows with what was measured: four times the runs take at most four times as much, and
//! not sixteen times, as a table of every row for every run would.

#![cfg(target_os = "linux")]

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

const FEW: usize = 350;
const ROWS: usize = 10;

/// Ramps of a sensor that the thermometer is ahead of, at levels all round.
fn table(runs: usize) -> String {
    let mut text = "run,kind,time_s,temperature_c,delta_f_hz,reference_g\n".to_owned();
    for run in 0..runs {
        let mut outside_c = -20.0 + 80.0 * (run % 37) as f64 / 37.0;
        let (mut inside_c, rate) = (outside_c, if run % 2 == 0 { 1.0 / 6.0 } else { -1.0 / 6.0 });
        for row in 0..ROWS {
            outside_c += rate;
            inside_c += (outside_c - inside_c) * 0.2;
            let level_g = f64::sin((row / 3 + run) as f64 * std::f64::consts::FRAC_PI_4);
            // Without a pattern, 5 µg or so.
            let noise_g = ((run * 7919 + row * 104_729) % 1009) as f64 * 1.7e-8;
            let warm_c = inside_c - 20.0;
            let delta_f_hz = 76.0 + 420.0 * (level_g + noise_g + 9e-4 * warm_c + 3e-6 * warm_c * warm_c);
            let time_s = row * 10;
            writeln!(text, "r{run},ramp,{time_s},{outside_c:.4},{delta_f_hz:.6},{level_g:.9}")
                .expect("a string takes it");
        }
    }
    text
}

/// Most memory that a command ever had, KiB.
fn peak_kib(folder: &Path, arguments: &[&str]) -> u64 {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    command.current_dir(folder).args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
    let mut process = command.spawn().expect("it starts");
    let status = format!("/proc/{}/status", process.id());
    let mut peak = 0;
    loop {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        peak = peak.max(kib.unwrap_or(0));
        if let Some(status) = process.try_wait().expect("a process") {
            assert!(status.success(), "{arguments:?}: {status}");
            return peak;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn four_times_the_runs_take_at_most_four_times_the_memory() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let diagnosed = |runs: usize| {
        let [data, model] = ["csv", "toml"].map(|ending| format!("{runs}.{ending}"));
        fs::write(folder.join(&data), table(runs)).expect("written");
        peak_kib(folder, &["train", &data, "-o", &model, "--restarts", "1"]);
        peak_kib(folder, &["diagnose", &model, &data])
    };
    let (few, many) = (diagnosed(FEW), diagnosed(4 * FEW));
    println!("{FEW} runs: {few} KiB; {} runs: {many} KiB", 4 * FEW);
    assert!(few > 10_000 && many <= 4 * few, "{few} KiB of {FEW} runs, {many} KiB of four times as many");
}
