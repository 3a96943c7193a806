//! `tempco verify MODEL DATA`

use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::progress::bar;
use clap::Args;
use firmware_sim::virtual_instrument::VirtualInstrument;
use protocol::{Blob, Request};
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use trainer::campaign::{Campaign, Run};
use trainer::model::Model;
use trainer::replay::replay;
use trainer::residuals::arranged;

/// Replays a campaign on the virtual instrument, over its own wire, and compares every reading's bits with this computer's.
#[derive(Args)]
#[command(after_help = "Example:  tempco verify model.toml campaign.csv")]
pub struct Verify {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    data: Data,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub fn run(&self) -> Result<Answer, Failure> {
        let model = Model::read(&self.model)?;
        let campaign = arranged(&model, &self.data.read()?)?;
        let parity = verify(&model.to_blob()?, &campaign)?;
        if self.json {
            let Parity { samples, identical, .. } = parity;
            anstream::println!("{:#}", serde_json::json!({ "samples": samples, "identical": identical }));
        } else {
            anstream::println!("{parity}");
        }
        Ok(if parity.identical == parity.samples { Answer::Yes } else { Answer::No })
    }
}

/// How many readings had the same bits.
#[derive(Clone, Debug, Serialize)]
pub struct Parity {
    pub samples: usize,
    pub identical: usize,
    first_difference: Option<String>,
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

/// Verifies with a progress bar.
pub fn verify(blob: &Blob, campaign: &Campaign) -> Result<Parity, Failure> {
    let bar = bar(campaign.row_count() as u64, "verifying");
    let parity = verified(blob, campaign, |samples| {
        bar.set_position(samples as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    parity
}

/// Uploads the blob to a virtual instrument and replays every run there and here. After each run `observe` sees how many
/// samples are done, and may end it.
pub fn verified(
    blob: &Blob,
    campaign: &Campaign,
    mut observe: impl FnMut(usize) -> ControlFlow<()>,
) -> Result<Parity, Failure> {
    let mut instrument = VirtualInstrument::new(&blob.serial);
    instrument.upload(blob)?;
    let mut parity = Parity { samples: 0, identical: 0, first_difference: None };
    for run in &campaign.runs {
        verify_run(blob, run, &mut instrument, &mut parity)?;
        if observe(parity.samples).is_break() {
            break;
        }
    }
    Ok(parity)
}

fn verify_run(blob: &Blob, run: &Run, instrument: &mut VirtualInstrument, parity: &mut Parity) -> Result<(), Failure> {
    let samples: Vec<_> = run.rows.iter().map(|row| row.sample).collect();
    // A run begins as after power-on: the host's replay starts with empty memories too.
    instrument.exchange(Request::Restart)?;
    let there = instrument.replay(&samples)?;
    let here = replay(blob, run)?;
    for (index, (there, here)) in there.iter().zip(&here).enumerate() {
        parity.samples += 1;
        if there.same_bits(here) {
            parity.identical += 1;
        } else if parity.first_difference.is_none() {
            parity.first_difference = Some(format!("run {}, row {}: {there:?} and {here:?}", run.name, index + 1));
        }
    }
    Ok(())
}
