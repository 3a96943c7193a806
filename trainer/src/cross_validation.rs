//! Does the model hold where it was not shown? Whole levels and whole temperatures are left out in turn.
//!
//! Held-out runs repeat the levels and nodes of the training runs, so a network that learnt these by
//! heart passes them. It fails here.

use crate::campaign::{Campaign, Row, Run, Split};
use crate::metrics::levels::{level_width, span};
use crate::noise::rms;
use crate::progress::Quiet;
use crate::residuals::{ResidualError, arranged, residuals};
use crate::train::{TrainError, TrainSettings, train};
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

/// What the figures mean.
pub const DEFINITION: &str = "the same training without any sample at the level (or temperature), then the RMS residual \
    of the samples there; the outermost levels and temperatures stay in, since leaving them out asks for extrapolation.";

/// Residuals at what was left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CrossValidation {
    /// RMS over all left-out levels, µg; `None` with fewer than three levels.
    pub levels_ug: Option<f64>,
    /// RMS over all left-out temperatures, µg; `None` with fewer than three temperatures.
    pub temperatures_ug: Option<f64>,
    /// Level by level.
    pub by_level: Vec<LeftOut>,
    /// Temperature by temperature.
    pub by_temperature: Vec<LeftOut>,
}

/// The residual at one left-out level or temperature.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// The middle of what was left out, g or °C.
    pub at: f64,
    /// Samples there.
    pub samples: usize,
    /// Their RMS residual, µg.
    pub residual_ug: f64,
}

/// Why there is no cross-validation.
#[derive(Debug, Error)]
pub enum CrossValidationError {
    /// A training failed.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// A model could not be evaluated.
    #[error(transparent)]
    Residual(#[from] ResidualError),
}

/// Levels this close are left out together, as a part of what all of them span: of a table from −1 to 1 g, ±15° about the
/// vertical. And so are references that no more than scatter about one level.
const LEVEL_WIDTH: f64 = 0.075;
/// Temperatures this close are left out together, °C.
const TEMPERATURE_WIDTH_C: f64 = 5.0;
/// A value must have this share of the rows to count as a level or node and not as a passage between them.
const LEAST_SHARE: f64 = 0.01;

/// Trains once for each inner level and temperature of the training runs.
///
/// # Errors
/// If a training fails.
pub fn cross_validate(
    campaign: &Campaign,
    split: &Split,
    settings: &TrainSettings,
) -> Result<CrossValidation, CrossValidationError> {
    let column = |value: fn(&Row) -> f64| -> Vec<f64> {
        let runs = split.training.iter().filter_map(|&index| campaign.runs.get(index));
        runs.flat_map(|run| &run.rows).map(value).collect()
    };
    let leave_out = |value: fn(&Row) -> f64, width: f64| -> Result<Vec<LeftOut>, CrossValidationError> {
        let clusters = clusters(column(value), width);
        let inner = clusters.get(1..clusters.len().saturating_sub(1)).unwrap_or_default();
        inner.par_iter().map(|cluster| without(campaign, split, settings, value, cluster)).collect()
    };
    let levels = column(|row| row.reference_g);
    let by_level = leave_out(|row| row.reference_g, (LEVEL_WIDTH * span(&levels)).max(level_width(&levels)))?;
    let by_temperature = leave_out(|row| f64::from(row.sample.temperature_uc) * 1e-6, TEMPERATURE_WIDTH_C)?;
    Ok(CrossValidation {
        levels_ug: pooled_ug(&by_level),
        temperatures_ug: pooled_ug(&by_temperature),
        by_level,
        by_temperature,
    })
}

fn pooled_ug(left_out: &[LeftOut]) -> Option<f64> {
    let samples: f64 = left_out.iter().map(|one| one.samples as f64).sum();
    let squares: f64 = left_out.iter().map(|one| one.samples as f64 * one.residual_ug.powi(2)).sum();
    (samples > 0.0).then(|| (squares / samples).sqrt())
}

/// A stretch of values, ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cluster {
    low: f64,
    high: f64,
}

impl Cluster {
    fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// Splits the values into stretches no wider than `width` that are worth leaving out.
fn clusters(mut values: Vec<f64>, width: f64) -> Vec<Cluster> {
    values.sort_by(f64::total_cmp);
    let least = (values.len() as f64 * LEAST_SHARE) as usize;
    let mut found = Vec::new();
    let mut rest = values.as_slice();
    while let Some(&low) = rest.first() {
        let (stretch, later) = rest.split_at(rest.partition_point(|value| *value <= low + width));
        if let Some(&high) = stretch.last().filter(|_| stretch.len() > least) {
            found.push(Cluster { low, high });
        }
        rest = later;
    }
    found
}

fn without(
    campaign: &Campaign,
    split: &Split,
    settings: &TrainSettings,
    value: fn(&Row) -> f64,
    cluster: &Cluster,
) -> Result<LeftOut, CrossValidationError> {
    let part = |run: &Run, inside: bool| Run {
        rows: run.rows.iter().filter(|row| cluster.holds(value(row)) == inside).copied().collect(),
        ..run.clone()
    };
    let outside = campaign.runs.iter().map(|run| part(run, false)).collect();
    let outside = Campaign::new(outside, campaign.channels.clone(), campaign.quantity.clone());
    let model = train(&outside, split, settings, &Quiet)?.model;
    let inside = campaign.runs.iter().map(|run| part(run, true)).filter(|run| !run.rows.is_empty()).collect();
    let inside = Campaign::new(inside, campaign.channels.clone(), campaign.quantity.clone());
    let inside = arranged(&model, &inside).map_err(ResidualError::from)?;
    let residuals = residuals(&model, &inside.runs)?;
    let all: Vec<f64> = residuals.runs.into_iter().flat_map(|run| run.residuals_g).collect();
    Ok(LeftOut { at: f64::midpoint(cluster.low, cluster.high), samples: all.len(), residual_ug: rms(&all) * 1e6 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_told_apart_and_passages_between_them_left_alone() {
        let mut values = vec![-1.0; 50];
        values.extend([0.0; 50]);
        values.extend([0.01; 50]);
        values.extend([1.0; 50]);
        values.push(0.5);
        let found = clusters(values, 0.15);
        let expected =
            [Cluster { low: -1.0, high: -1.0 }, Cluster { low: 0.0, high: 0.01 }, Cluster { low: 1.0, high: 1.0 }];
        assert_eq!(found, expected);
    }
}
