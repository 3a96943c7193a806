//! `tempco device monitor PORT`

use super::target::Target;
use super::watch::{Pace, watch};
use crate::failure::{Answer, Failure};
use crate::render::status::{names, words};
use crate::terminal::say;
use clap::Args;
use firmware_sim::link::{Content, Unasked};
use protocol::{Reading, Streamed};

/// Shows readings as they come, until Ctrl-C.
#[derive(Args)]
#[command(after_help = "Example:  tempco device monitor /dev/ttyUSB0 --every-ms 1000 --count 60")]
pub struct Monitor {
    #[command(flatten)]
    target: Target,

    #[command(flatten)]
    pace: Pace,
}

impl Monitor {
    pub fn run(&self) -> Result<Answer, Failure> {
        let json = self.target.json;
        if !json {
            say!("{:>10}  {:>12}  status", "time s", "reading g")?;
        }
        watch(&self.target, &self.pace, Streamed::Readings, |message| match &message.content {
            Content::Reading(reading) if json => line(message, reading),
            Content::Reading(reading) => row(reading),
            Content::Sample(_) => String::new(),
        })
    }
}

fn row(reading: &Reading) -> String {
    let time_s = reading.time_us as f64 * 1e-6;
    if reading.acceleration_g.is_nan() {
        format!("{time_s:>10.3}  {:>12}  {}", "–", words(reading.status))
    } else {
        format!("{time_s:>10.3}  {:>+12.6}  {}", reading.acceleration_g, words(reading.status))
    }
}

fn line(message: &Unasked, reading: &Reading) -> String {
    let number = Some(reading.acceleration_g).filter(|value| value.is_finite());
    let line = serde_json::json!({
        "number": message.number, "time_us": reading.time_us, "acceleration_g": number, "status": names(reading.status),
    });
    line.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Status;

    #[test]
    fn a_reading_has_its_sign_and_one_without_a_number_says_why() {
        let reading = Reading { time_us: 2_250_000, acceleration_g: 0.25, status: Status::empty() };
        assert_eq!(row(&reading), "     2.250     +0.250000  good");
        let none = Reading::none(2_250_000, Status::UNCALIBRATED);
        assert_eq!(row(&none), "     2.250             –  uncalibrated");
        let message = |reading| Unasked { number: 3, content: Content::Reading(reading) };
        let told = |reading: Reading| -> serde_json::Value {
            serde_json::from_str(&line(&message(reading), &reading)).expect("JSON")
        };
        let expected = serde_json::json!({"number": 3, "time_us": 2_250_000, "acceleration_g": 0.25, "status": []});
        assert_eq!(told(reading), expected);
        assert_eq!(told(none)["acceleration_g"], serde_json::Value::Null);
    }
}
