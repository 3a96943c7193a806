//! What there is between one action and the next: the campaign, the models made of it, and the answers about them.

use super::job::{Job, Step};
use super::shelf::Shelved;
use super::{commands, places};
use crate::command::inspect::RunSummary;
use crate::command::train::Simpler;
use crate::command::verify::Parity;
use crate::data::{Data, HeldOut};
use crate::failure::Failure;
use crate::output::write_whole;
use serde::Serialize;
use std::collections::HashSet;
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
    /// Number of the campaign that is looked at.
    pub campaign: usize,
    pub measured: Option<Measured>,
    /// Of this campaign, in the order in which they were made.
    pub models: Vec<Entry>,
    /// Number of the model that is looked at.
    pub current: Option<usize>,
    /// The other campaigns with their models.
    pub shelf: Vec<Shelved>,
    /// Folders that take files until they are read.
    pub uploads: Vec<PathBuf>,
    /// Why the last action came to nothing.
    pub refused: Option<Refused>,
    /// What the user stopped last.
    pub stopped: Option<Step>,
    job: Option<Arc<Job>>,
    running: bool,
    pub training: Option<Arc<Job>>,
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
            campaign: 0,
            measured: None,
            models: Vec::new(),
            current: None,
            shelf: Vec::new(),
            uploads: Vec::new(),
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

    /// Writes a new model under a number that nothing has yet, and looks at it from now on.
    pub fn add(&mut self, entry: Entry) -> Result<(), Failure> {
        let number = self.next_number();
        let file = places::model(&self.folder, number);
        write_whole(&file, entry.model.to_text().as_bytes())?;
        let command = commands::into(&entry.command, &file);
        // Every model of a campaign sees the same samples: once is enough.
        let columns =
            self.models.first().map_or_else(|| Arc::clone(&entry.columns), |first| Arc::clone(&first.columns));
        self.models.push(Entry { number, file, command, columns, ..entry });
        self.current = Some(number);
        Ok(())
    }

    pub fn entry(&mut self, number: usize) -> Option<&mut Entry> {
        self.models.iter_mut().find(|entry| entry.number == number)
    }

    /// The number of the next model: no file of any day has it, and no model of any campaign.
    pub fn next_number(&self) -> usize {
        let shelved = self.shelf.iter().flat_map(|one| &one.models);
        let numbers: HashSet<usize> = self.models.iter().chain(shelved).map(|entry| entry.number).collect();
        let free = |number: &usize| !numbers.contains(number) && places::is_free(&self.folder, *number);
        (1..).find(free).unwrap_or_default()
    }

    /// A command of the next model, as it stands while that is being trained.
    pub fn foretold(&self, command: &str) -> String {
        commands::into(command, &places::model(&self.folder, self.next_number()))
    }
}
