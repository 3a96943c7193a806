//! `tempco device raw PORT`

use super::target::Target;
use super::watch::{Pace, watch};
use crate::failure::{Answer, Failure};
use crate::render::status::names;
use crate::terminal::say;
use clap::Args;
use firmware_sim::link::{Content, Unasked};
use protocol::{Sample, Streamed};

/// Shows raw samples as they come, as the lines of a table in CSV, until Ctrl-C.
#[derive(Args)]
#[command(after_help = "Example:  tempco device raw /dev/ttyUSB0 > zero-1.csv")]
pub struct Raw {
    #[command(flatten)]
    target: Target,

    #[command(flatten)]
    pace: Pace,
}

impl Raw {
    pub fn run(&self) -> Result<Answer, Failure> {
        let json = self.target.json;
        if !json {
            say!("time_s,temperature_c,delta_f_hz,sum_f_hz,faults")?;
        }
        watch(&self.target, &self.pace, Streamed::Samples, |message| match &message.content {
            Content::Sample(sample) if json => line(message, sample),
            Content::Sample(sample) => row(sample),
            Content::Reading(_) => String::new(),
        })
    }
}

/// What was not measured is left empty.
fn row(sample: &Sample) -> String {
    let (temperature_c, delta_f_hz) = measured(sample);
    let text = |value: Option<f64>| value.map(|value| format!("{value:.6}")).unwrap_or_default();
    let sum_f_hz = sample.sum_f_uhz.map(|sum| sum as f64 * 1e-6);
    let (time_s, faults) = (sample.time_us as f64 * 1e-6, names(sample.faults).join(" "));
    format!("{time_s:.6},{},{},{},{faults}", text(temperature_c), text(delta_f_hz), text(sum_f_hz))
}

fn line(message: &Unasked, sample: &Sample) -> String {
    let (temperature_c, delta_f_hz) = measured(sample);
    let line = serde_json::json!({
        "number": message.number, "time_us": sample.time_us, "temperature_c": temperature_c, "delta_f_hz": delta_f_hz,
        "sum_f_hz": sample.sum_f_uhz.map(|sum| sum as f64 * 1e-6), "faults": names(sample.faults),
    });
    line.to_string()
}

/// Temperature and frequency difference, where their sensors gave them.
fn measured(sample: &Sample) -> (Option<f64>, Option<f64>) {
    use protocol::Status;
    let good = |fault: Status| !sample.faults.contains(fault);
    (
        good(Status::THERMOMETER_FAULT).then(|| f64::from(sample.temperature_uc) * 1e-6),
        good(Status::RESONATOR_FAULT).then_some(sample.delta_f_uhz as f64 * 1e-6),
    )
}
