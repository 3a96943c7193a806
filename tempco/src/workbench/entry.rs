//! A model of the workbench, and what was found out about it.

use crate::command::train::Simpler;
use crate::command::verify::Parity;
use crate::failure::Failure;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;
use trainer::campaign::Campaign;
use trainer::compare::{Comparison, compare};
use trainer::diagnose::Diagnosis;
use trainer::diagnose::plan::Plan;
use trainer::ladder::Rung;
use trainer::linked::Columns;
use trainer::model::Model;
use trainer::residuals::{arranged, residuals};

/// A model and what was found out about it.
pub struct Entry {
    /// The one in its file's name, which is no other model's.
    pub number: usize,
    pub file: PathBuf,
    /// The model that it came from.
    pub parent: Option<usize>,
    pub title: String,
    pub command: String,
    pub model: Arc<Model>,
    pub comparison: Comparison,
    /// Row by row in the campaign's order, µg.
    pub residuals_ug: Arc<Vec<f32>>,
    /// What they may depend on.
    pub columns: Arc<Columns>,
    pub simpler: Vec<Simpler>,
    pub ladder: Vec<Rung>,
    /// What speaks against the effect on its last rung.
    pub doubts: Vec<String>,
    pub diagnosis: Option<Arc<Diagnosis>>,
    pub parity: Option<Parity>,
    pub exported: Option<Exported>,
    pub planned: Option<Planned>,
}

/// A calibration on disk.
#[derive(Clone, Debug)]
pub struct Exported {
    /// Files and what was written into them: Intel HEX, the bare blob.
    pub files: [(PathBuf, Vec<u8>); 2],
    /// Where a device looks for it.
    pub address: String,
}

/// The next recording.
#[derive(Clone, Debug, Serialize)]
pub struct Planned {
    #[serde(flatten)]
    pub plan: Plan,
    /// The same for people.
    pub text: String,
    /// The command that planned it.
    pub command: String,
    /// The best recording's scenario, if any is worth making.
    #[serde(skip)]
    pub file: Option<PathBuf>,
}

/// Where a new model comes from.
pub struct Origin {
    pub parent: Option<usize>,
    pub title: String,
    /// Without the model's place, which it gets last of all.
    pub command: String,
}

impl Entry {
    /// Compares the model with the campaign.
    pub fn new(origin: Origin, model: Model, campaign: &Campaign) -> Result<Self, Failure> {
        let comparison = compare(&model, campaign)?;
        Self::compared(origin, model, comparison, campaign)
    }

    /// A model that was compared already.
    pub fn compared(
        origin: Origin,
        model: Model,
        comparison: Comparison,
        campaign: &Campaign,
    ) -> Result<Self, Failure> {
        let Origin { parent, title, command } = origin;
        let arranged = arranged(&model, campaign).map_err(Failure::from)?;
        let residuals = residuals(&model, &arranged.runs)?;
        let columns = Columns::of(&residuals);
        let residuals_ug = residuals.runs.iter().flat_map(|run| &run.residuals_g).map(|g| (g * 1e6) as f32).collect();
        Ok(Self {
            number: 0,
            file: PathBuf::new(),
            parent,
            title,
            command,
            model: Arc::new(model),
            comparison,
            residuals_ug: Arc::new(residuals_ug),
            columns: Arc::new(columns),
            simpler: Vec::new(),
            ladder: Vec::new(),
            doubts: Vec::new(),
            diagnosis: None,
            parity: None,
            exported: None,
            planned: None,
        })
    }
}
