//! What there is between one action and the next: the campaign, the models made of it, and the answers about them.

mod shelf;

use super::entry::Entry;
use super::job::{Job, Step};
use super::measured::Measured;
use super::refusal::Refusal;
use super::shelved::Shelved;
use super::{commands, places};
use crate::failure::Failure;
use crate::output::write_whole;
use axum::http::StatusCode;
use serde::Serialize;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

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

    /// Refuses while work goes on.
    pub fn idle(&self) -> Result<(), Refusal> {
        if !self.is_busy() {
            return Ok(());
        }
        let failure = Failure::new("something else is at work").help("wait for it, or stop it first");
        Err(Refusal { status: StatusCode::CONFLICT, failure })
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
