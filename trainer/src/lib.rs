//! From calibration measurements to a compensation model.
//!
//! A library: it prints nothing, reads no clock and knows no simulator. One free function a verb. Campaigns are
//! [read](campaign::Campaign::read) from tables, or made in memory, as here of a sensor of 80 Hz/g that drifts by 1 Hz
//! over 60 °C:
//!
//! ```
//! use protocol::Sample;
//! use trainer::campaign::{Campaign, HoldOut, Quantity, Row, Run};
//! use trainer::compare::compare;
//! use trainer::progress::Quiet;
//! use trainer::train::{TrainSettings, train};
//!
//! let row = |k: u64| {
//!     let (level_g, temperature_uc) = ((k % 5) as f64 / 2.0 - 1.0, k as i32 / 5 * 10_000_000 - 10_000_000);
//!     let delta_f_uhz = 76_000_000 + (80e6 * level_g) as i64 + i64::from(temperature_uc) / 60;
//!     let sample = Sample::from_difference(k * 60_000_000, delta_f_uhz, temperature_uc);
//!     Row { sample, reference_g: level_g, reference_sigma_g: None }
//! };
//! let run = |name: &str| Run {
//!     name: name.to_owned(),
//!     kind: "full".to_owned(),
//!     source: "memory".into(),
//!     rows: (0..35).map(row).collect(),
//! };
//! let campaign = Campaign::new(vec![run("one"), run("two")], Vec::new(), Quantity::default());
//!
//! let split = campaign.split(&HoldOut::LastOfEachKind)?;
//! let trained = train(&campaign, &split, &TrainSettings { restarts: 1, ..TrainSettings::new(1) }, &Quiet)?;
//! let comparison = compare(&trained.model, &campaign)?;
//! assert!(comparison.residual_ug < 1.0, "{} µg", comparison.residual_ug);
//! let blob = trained.model.to_blob()?; // as a device stores it
//! # assert!(blob.serial.is_empty());
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
