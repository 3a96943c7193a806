//! From calibration measurements to a compensation model.
//!
//! A library: it prints nothing, reads no clock and knows no simulator. One free function a verb:
//!
//! ```no_run
//! use trainer::campaign::{Campaign, HoldOut, ReadOptions};
//! use trainer::compare::compare;
//! use trainer::progress::Quiet;
//! use trainer::train::{TrainSettings, train};
//!
//! let campaign = Campaign::read(&["campaign.csv".into()], &ReadOptions::default())?;
//! let split = campaign.split(&HoldOut::LastOfEachKind)?;
//! let trained = train(&campaign, &split, &TrainSettings::new(1), &Quiet)?;
//! let comparison = compare(&trained.model, &campaign)?;
//! let blob = trained.model.to_blob()?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod campaign;
pub mod compare;
pub mod cross_validation;
pub mod diagnose;
pub mod effect_choice;
pub mod expression;
pub mod fit;
pub mod ladder;
pub mod linked;
pub mod metrics;
pub mod model;
pub mod noise;
pub mod progress;
pub mod replay;
pub mod report;
pub mod reproduction;
pub mod residuals;
pub mod retrain;
pub mod sensitivity;
pub mod train;
mod units;
mod warnings;
mod yardstick;
