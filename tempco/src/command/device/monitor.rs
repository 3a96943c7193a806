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
