//! Readings minus references.

use crate::campaign::{Campaign, CampaignError, Run};
use crate::model::{DeviceLimit, Model};
use crate::noise::rms;
use crate::replay::replay;
use firmware_core::LoadError;
use protocol::{Reading, Status};
use thiserror::Error;

/// Residuals of a model on some runs.
#[derive(Clone, Debug)]
pub struct Residuals<'a> {
    /// Run by run.
    pub runs: Vec<RunResiduals<'a>>,
}

/// Residuals of a model on one run.
#[derive(Clone, Debug)]
pub struct RunResiduals<'a> {
    /// The run.
    pub run: &'a Run,
    /// What the device reads for each row.
    pub readings: Vec<Reading>,
    /// Reading minus reference of each row, g.
    pub residuals_g: Vec<f64>,
}

impl RunResiduals<'_> {
    /// Root mean square, g.
    #[must_use]
    pub fn rms_g(&self) -> f64 {
        rms(&self.residuals_g)
    }

    /// Readings that were flagged.
    #[must_use]
    pub fn flagged(&self) -> usize {
        self.readings.iter().filter(|reading| !reading.status.is_empty()).count()
    }
}

/// Why there are no residuals.
#[derive(Debug, Error)]
pub enum ResidualError {
    /// The model has no device form.
    #[error(transparent)]
    Model(#[from] DeviceLimit),
    /// The core refuses the blob.
    #[error("the core refuses the model: {0}")]
    Load(#[from] LoadError),
    /// The campaign lacks a channel that the model uses.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// A row gave no number.
    #[error("run `{run}`, row {row}: no reading ({status:?})")]
    NoNumber {
        /// The run.
        run: String,
        /// The row within it, from 1.
        row: usize,
        /// Why.
        status: Status,
    },
}

/// The campaign with its auxiliary channels in the model's order.
///
/// # Errors
/// [`CampaignError`] if it lacks one.
pub fn arranged(model: &Model, campaign: &Campaign) -> Result<Campaign, CampaignError> {
    if model.channels.is_empty() || model.channels == campaign.channels {
        return Ok(campaign.clone());
    }
    let names: Vec<&str> = model.channels.iter().map(String::as_str).collect();
    campaign.arranged(&names)
}

/// Residuals of `model` on `runs`, evaluated in the device's own arithmetic.
///
/// # Errors
/// [`ResidualError`] says which model or row is at fault.
pub fn residuals<'a>(model: &Model, runs: impl IntoIterator<Item = &'a Run>) -> Result<Residuals<'a>, ResidualError> {
    let blob = model.to_blob()?;
    let of = |run: &'a Run| {
        let readings = replay(&blob, run)?;
        let residuals_g = differences(run, &readings)?;
        Ok(RunResiduals { run, readings, residuals_g })
    };
    Ok(Residuals { runs: runs.into_iter().map(of).collect::<Result<_, ResidualError>>()? })
}

fn differences(run: &Run, readings: &[Reading]) -> Result<Vec<f64>, ResidualError> {
    let pairs = run.rows.iter().zip(readings).enumerate();
    let difference = |(index, (row, reading)): (usize, (&crate::campaign::Row, &Reading))| {
        if reading.status.intersects(Status::FATAL) {
            let run = run.name.clone();
            return Err(ResidualError::NoNumber { run, row: index + 1, status: reading.status });
        }
        Ok(f64::from(reading.acceleration_g) - row.reference_g)
    };
    pairs.map(difference).collect()
}
