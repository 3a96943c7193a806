//! A campaign of the workbench.

use crate::command::inspect::RunSummary;
use crate::data::{Data, HeldOut};
use crate::failure::Failure;
use std::path::PathBuf;
use std::sync::Arc;
use trainer::campaign::{Campaign, Split};

/// A campaign and how it is divided.
#[derive(Clone)]
pub struct Measured {
    pub data: Data,
    /// Files beside the data that say how to read it.
    pub mappings: Vec<PathBuf>,
    pub campaign: Arc<Campaign>,
    pub runs: Arc<Vec<RunSummary>>,
    pub held_out: HeldOut,
    pub split: Result<Split, Failure>,
    pub blind: Option<Blind>,
}

/// What is known of a campaign that hides something.
#[derive(Clone)]
pub struct Blind {
    pub envelope: PathBuf,
    /// The command that made it.
    pub command: String,
    /// What noise alone would leave on the held-out runs, as the simulation states it, µg.
    pub noise_ug: f64,
    /// What was hidden, once the seal is broken.
    pub revealed: Option<serde_json::Value>,
}
