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

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Status;

    #[test]
    fn a_row_is_in_the_units_of_its_header_and_what_failed_is_empty() {
        let sample = Sample::from_pair(1_500_000, 40_000_250_000, 39_999_750_000, -12_345_678);
        assert_eq!(row(&sample), "1.500000,-12.345678,0.500000,80000.000000,");
        let broken = Sample { faults: Status::THERMOMETER_FAULT, ..sample };
        assert_eq!(row(&broken), "1.500000,,0.500000,80000.000000,thermometer-fault");
        let silent = Sample { faults: Status::RESONATOR_FAULT, sum_f_uhz: None, ..sample };
        assert_eq!(row(&silent), "1.500000,-12.345678,,,resonator-fault");

        let message = |sample| Unasked { number: 7, content: Content::Sample(sample) };
        let told: serde_json::Value = serde_json::from_str(&line(&message(broken), &broken)).expect("JSON");
        let expected = serde_json::json!({
            "number": 7, "time_us": 1_500_000, "temperature_c": null, "delta_f_hz": 0.5, "sum_f_hz": 80_000.0,
            "faults": ["thermometer-fault"],
        });
        assert_eq!(told, expected);
        assert_eq!(measured(&silent), (Some(-12_345_678.0 * 1e-6), None));
    }
}
