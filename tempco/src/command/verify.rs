//! `tempco verify MODEL DATA --on PORT`

use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::link::{AnyLink, PORTS, Port};
use crate::progress::bar;
use crate::shell;
use crate::terminal::{remark, say};
use clap::Args;
use protocol::{Blob, Signed};
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;
use trainer::campaign::{Campaign, Run};
use trainer::model::Model;
use trainer::replay::replay;
use trainer::residuals::arranged;

/// Replays a campaign on an instrument, over its line, and compares every reading's bits with this computer's.
///
/// An instrument that is made for the occasion gets the calibration first; any other one must hold it.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco verify model.toml campaign.csv\n          tempco verify model.toml campaign.csv --on qemu\n          tempco verify model.toml campaign.csv --on /dev/ttyUSB0"
)]
pub struct Verify {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    data: Data,

    #[arg(
        long,
        value_name = "PORT",
        default_value = "sim",
        help = format!("Which instrument: `sim`, the virtual one; `qemu` or `qemu:IMAGE`, the microcontroller's image in QEMU; or {PORTS}")
    )]
    on: Port,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Verify {
    #[expect(clippy::disallowed_methods, reason = "how fast a line is takes a clock")]
    pub fn run(&self) -> Result<Answer, Failure> {
        let model = Model::read(&self.model)?;
        let campaign = arranged(&model, &self.data.read_for(&model)?)?;
        let blob = model.to_blob()?;
        let mut link = self.on.open(&blob.serial)?;
        if self.on.is_made_anew() {
            link.upload_blob(&blob)?;
        } else if !holds(&mut link, &model.to_bytes()?)? {
            return self.other();
        }
        let started = Instant::now();
        let parity = shown(&blob, &campaign, &mut link)?;
        let per_s = parity.samples as f64 / started.elapsed().as_secs_f64();
        if self.json {
            let Parity { samples, identical, .. } = parity;
            say!("{:#}", serde_json::json!({ "samples": samples, "identical": identical }))?;
        } else {
            say!("{parity}")?;
            // Beside the answer, which is the same every time.
            remark!("{per_s:.0} readings/s, there and back");
        }
        Ok(if parity.holds() { Answer::Yes } else { Answer::No })
    }

    fn other(&self) -> Result<Answer, Failure> {
        if self.json {
            say!("{:#}", serde_json::json!({ "samples": 0, "identical": 0, "other_calibration": true }))?;
        } else {
            say!(
                "The instrument holds another calibration than {}. Write this one with  tempco flash {} --to PORT",
                self.model.display(),
                shell::path(&self.model)
            )?;
        }
        Ok(Answer::No)
    }
}

/// Whether the instrument holds this very calibration, signed or not.
fn holds(link: &mut AnyLink, blob: &[u8]) -> Result<bool, Failure> {
    if link.state()?.provenance.is_none() {
        return Ok(false);
    }
    let held = link.read_calibration()?;
    Ok(Signed::split(&held).is_some_and(|held| held.blob == blob))
}

/// How many readings had the same bits.
#[derive(Clone, Debug, Serialize)]
pub struct Parity {
    pub samples: usize,
    pub identical: usize,
    first_difference: Option<String>,
}

impl Parity {
    /// Whether all of them had.
    pub const fn holds(&self) -> bool {
        self.identical == self.samples
    }
}

impl std::fmt::Display for Parity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} of {} readings identical in every bit", self.identical, self.samples)?;
        match &self.first_difference {
            Some(place) => write!(f, "; first difference: {place}"),
            None => Ok(()),
        }
    }
}

/// Writes the blob into a virtual instrument and replays every run there and here, with a progress bar.
pub fn verify(blob: &Blob, campaign: &Campaign) -> Result<Parity, Failure> {
    let mut link = uploaded(blob)?;
    shown(blob, campaign, &mut link)
}

/// The same without a bar. After each run `observe` sees how many samples are done, and may end it.
pub fn verified(
    blob: &Blob,
    campaign: &Campaign,
    observe: impl FnMut(usize) -> ControlFlow<()>,
) -> Result<Parity, Failure> {
    let mut link = uploaded(blob)?;
    compare(blob, campaign, &mut link, observe)
}

fn uploaded(blob: &Blob) -> Result<AnyLink, Failure> {
    let mut link = Port::Sim.open(&blob.serial)?;
    link.upload_blob(blob)?;
    Ok(link)
}

/// Compares with a progress bar.
fn shown(blob: &Blob, campaign: &Campaign, link: &mut AnyLink) -> Result<Parity, Failure> {
    let bar = bar(campaign.row_count() as u64, "verifying");
    let parity = compare(blob, campaign, link, |samples| {
        bar.set_position(samples as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    parity
}

/// Replays every run there and here.
fn compare(
    blob: &Blob,
    campaign: &Campaign,
    link: &mut AnyLink,
    mut observe: impl FnMut(usize) -> ControlFlow<()>,
) -> Result<Parity, Failure> {
    let mut parity = Parity { samples: 0, identical: 0, first_difference: None };
    for run in &campaign.runs {
        compare_run(blob, run, link, &mut parity)?;
        if observe(parity.samples).is_break() {
            break;
        }
    }
    // What comes next is the instrument's own life again.
    link.restart()?;
    Ok(parity)
}

fn compare_run(blob: &Blob, run: &Run, link: &mut AnyLink, parity: &mut Parity) -> Result<(), Failure> {
    let here = replay(blob, run)?;
    // A run begins as after power-on: the host's replay starts with empty memories too.
    link.restart()?;
    for (index, (row, here)) in run.rows.iter().zip(&here).enumerate() {
        let there = link.replay(&row.sample)?;
        parity.samples += 1;
        if there.same_bits(here) {
            parity.identical += 1;
        } else if parity.first_difference.is_none() {
            parity.first_difference = Some(format!("run {}, row {}: {there:?} and {here:?}", run.name, index + 1));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::Network;
    use protocol::{Domain, Sample, Scaling, Timing, Weights};
    use std::path::PathBuf;
    use trainer::campaign::{Quantity, Row};

    /// A calibration of 4 mg/Hz about 76 Hz with this bias.
    fn blob(bias_g: f32) -> Blob {
        let weights = Weights::from_array(&[0.0; 41]);
        Blob {
            serial: "A-1".try_into().expect("a short name"),
            provenance: [0; 8],
            proof: Network::<f32>::new(&weights).proof().expect("finite outputs"),
            scaling: Scaling {
                delta_f_zero_uhz: 76_000_000,
                delta_f_gain_per_hz: 1.0,
                temperature_zero_uc: 25_000_000,
                temperature_gain_per_c: 0.02,
                line_g: [bias_g, 0.004, 0.0, 0.0],
                output_g: 0.0,
            },
            weights,
            domain: Domain { delta_f_uhz: (0, 152_000_000), temperature_uc: (-40_000_000, 85_000_000) },
            timing: Timing { max_gap_us: u32::MAX },
            channels: Default::default(),
            terms: Default::default(),
        }
    }

    fn campaign() -> Campaign {
        let row = |k: i64| Row {
            sample: Sample::from_difference(k.unsigned_abs() * 1_000_000, k * 1_000_000, 25_000_000),
            reference_g: 0.0,
            reference_sigma_g: None,
        };
        let rows = (0..100).map(row).collect();
        let run = Run { name: "run".into(), kind: "ramp".into(), source: PathBuf::new(), rows };
        Campaign::new(vec![run], Vec::new(), Quantity::default())
    }

    #[test]
    fn readings_of_the_same_calibration_are_identical_and_those_of_another_are_counted_as_other() {
        let parity = verify(&blob(0.0), &campaign()).expect("an instrument");
        assert_eq!((parity.samples, parity.identical), (100, 100));
        assert!(parity.holds() && parity.first_difference.is_none());
        // A thousandth of a µg shows only where the reading is small: floats near ±0.3 g are further apart.
        for (bias_g, fewest) in [(1e-9, 1), (1e-3, 100)] {
            let mut link = uploaded(&blob(bias_g)).expect("an instrument");
            let go_on = |_| ControlFlow::Continue(());
            let parity = compare(&blob(0.0), &campaign(), &mut link, go_on).expect("an answer");
            assert_eq!(parity.samples, 100);
            assert!(parity.identical <= 100 - fewest && !parity.holds(), "{parity}");
            assert!(parity.first_difference.is_some_and(|place| place.starts_with("run run, row ")));
        }
    }
}
