//! What there is between one action and the next: the campaign, the models made of it, and the answers about them.

use super::job::{Job, Step};
use crate::command::inspect::RunSummary;
use crate::command::train::Simpler;
use crate::command::verify::Parity;
use crate::data::{Data, HeldOut};
use crate::failure::Failure;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;
use trainer::campaign::{Campaign, Split};
use trainer::compare::{Comparison, compare};
use trainer::diagnose::Diagnosis;
use trainer::diagnose::plan::Plan;
use trainer::ladder::Rung;
use trainer::linked::Columns;
use trainer::model::Model;
use trainer::residuals::{arranged, residuals};

/// Everything that a page shows.
pub struct Session {
    pub folder: PathBuf,
    /// Counts changes, so that a page knows when to look again.
    pub version: u64,
    pub measured: Option<Measured>,
    /// In the order in which they were made.
    pub models: Vec<Entry>,
    /// Number of the model that is looked at.
    pub current: Option<usize>,
    /// Why the last action came to nothing.
    pub refused: Option<Refused>,
    /// What the user stopped last.
    pub stopped: Option<Step>,
    job: Option<Arc<Job>>,
    running: bool,
    training: Option<Arc<Job>>,
    jobs: u64,
}

/// An action that came to nothing.
#[derive(Clone, Debug, Serialize)]
pub struct Refused {
    pub step: Step,
    #[serde(flatten)]
    pub failure: Failure,
}

/// A campaign and how it is divided.
#[derive(Clone)]
pub struct Measured {
    pub data: Data,
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

/// A model and what was found out about it.
pub struct Entry {
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
    pub diagnosis: Option<Arc<Diagnosis>>,
    pub parity: Option<Parity>,
    pub exported: Option<Exported>,
    pub planned: Option<Planned>,
}

/// A calibration on disk.
#[derive(Clone, Debug, Serialize)]
pub struct Exported {
    pub hex: PathBuf,
    pub bin: PathBuf,
    pub bytes: usize,
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
    /// The best recording's scenario, if any is worth making.
    pub file: Option<PathBuf>,
}

/// A model that is new, and where it comes from.
pub struct Origin {
    pub file: PathBuf,
    pub parent: Option<usize>,
    pub title: String,
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
        let Origin { file, parent, title, command } = origin;
        let arranged = arranged(&model, campaign).map_err(Failure::from)?;
        let residuals = residuals(&model, &arranged.runs)?;
        let columns = Columns::of(&residuals);
        let residuals_ug = residuals.runs.iter().flat_map(|run| &run.residuals_g).map(|g| (g * 1e6) as f32).collect();
        Ok(Self {
            number: 0,
            file,
            parent,
            title,
            command,
            model: Arc::new(model),
            comparison,
            residuals_ug: Arc::new(residuals_ug),
            columns: Arc::new(columns),
            simpler: Vec::new(),
            ladder: Vec::new(),
            diagnosis: None,
            parity: None,
            exported: None,
            planned: None,
        })
    }
}

impl Session {
    pub fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            version: 0,
            measured: None,
            models: Vec::new(),
            current: None,
            refused: None,
            stopped: None,
            job: None,
            running: false,
            training: None,
            jobs: 0,
        }
    }

    pub const fn is_busy(&self) -> bool {
        self.running
    }

    pub const fn next_job(&mut self) -> u64 {
        self.jobs += 1;
        self.jobs
    }

    pub fn begin(&mut self, job: Arc<Job>) {
        self.version += 1;
        (self.refused, self.stopped, self.running) = (None, None, true);
        if matches!(job.step, Step::Train | Step::Add) {
            self.training = Some(Arc::clone(&job));
        }
        self.job = Some(job);
    }

    pub const fn end(&mut self) {
        self.running = false;
    }

    /// The work that goes on.
    pub fn running(&self) -> Option<&Arc<Job>> {
        self.job.as_ref().filter(|_| self.running)
    }

    /// Whose reports a page draws: the last training, and what goes on.
    pub fn told_by(&self) -> Vec<Arc<Job>> {
        let mut jobs: Vec<_> = self.training.iter().chain(self.running()).cloned().collect();
        jobs.dedup_by_key(|job| job.number);
        jobs
    }

    /// Another campaign takes the place of everything.
    pub fn take(&mut self, measured: Measured) {
        (self.measured, self.current, self.training) = (Some(measured), None, None);
        self.models.clear();
    }

    /// A new model, which is looked at from now on.
    pub fn add(&mut self, entry: Entry) {
        let number = self.models.last().map_or(1, |last| last.number + 1);
        // Every model sees the same samples: once is enough.
        let columns =
            self.models.first().map_or_else(|| Arc::clone(&entry.columns), |first| Arc::clone(&first.columns));
        self.models.push(Entry { number, columns, ..entry });
        self.current = Some(number);
    }

    pub fn entry(&mut self, number: usize) -> Option<&mut Entry> {
        self.models.iter_mut().find(|entry| entry.number == number)
    }

    /// A file for the next model that no earlier one has, of today or of another day.
    pub fn new_file(&self) -> PathBuf {
        let taken = |file: &PathBuf| file.exists() || self.models.iter().any(|entry| entry.file == *file);
        let name = |number: usize| self.folder.join(format!("model-{number}.toml"));
        (1..).map(name).find(|file| !taken(file)).unwrap_or_else(|| self.folder.join("model.toml"))
    }

    /// Where a model's calibration is written.
    pub fn calibration(&self, number: usize, ending: &str) -> PathBuf {
        self.folder.join(format!("calibration-{number}.{ending}"))
    }
}
