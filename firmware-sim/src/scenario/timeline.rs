//! The scenario on the calendar: every repetition of every run with its beginning and its segments.
//!
//! Apart from the simulation so that a scenario can be refused, and its length told, before anything is simulated.

use crate::scenario::error::ScenarioError;
use crate::scenario::programme::{MAX_SEGMENTS, Programme, Segment};
use crate::scenario::run::Run;
use crate::twin::conditions::DAY_S;
use crate::twin::random::Random;
use crate::twin::rig::Rig;
use crate::twin::truth::Truth;
use std::collections::HashSet;

/// The most samples that a scenario may ask for: about 2 GB in memory.
const MAX_ROWS: u64 = 10_000_000;

/// The most time steps that may be simulated: an hour or so of work.
const MAX_STEPS: u64 = 10_000_000_000;

/// What the calendar must know besides the runs.
#[derive(Clone, Copy, Debug)]
pub struct Lab<'a> {
    /// The device.
    pub device: &'a Truth,
    /// The laboratory.
    pub rig: &'a Rig,
    /// Time step of the simulation, s.
    pub step_s: f64,
}

/// All runs of a scenario in order of time.
#[derive(Clone, Debug)]
pub struct Timeline<'a> {
    /// The runs, repetitions spelt out.
    pub runs: Vec<PlannedRun<'a>>,
}

/// One run with its place on the calendar.
#[derive(Clone, Debug)]
pub struct PlannedRun<'a> {
    /// Name, unique.
    pub name: String,
    /// What the scenario says about it.
    pub run: &'a Run,
    /// Age of the device when it begins, s.
    pub begins_s: f64,
    /// How many steps pass between kept samples.
    pub every: u64,
    /// What happens.
    pub segments: Vec<Segment>,
}

impl<'a> Timeline<'a> {
    /// Lays the runs out; `seed` decides the random orders.
    ///
    /// # Errors
    /// If runs overlap, share a name, keep nothing, or keep too much.
    pub fn of(runs_in_order: &'a [Run], lab: Lab<'_>, seed: u64) -> Result<Self, ScenarioError> {
        let mut runs: Vec<PlannedRun> = Vec::new();
        let mut names = HashSet::new();
        let mut sum = Sum::default();
        for run in runs_in_order {
            for repetition in 0..run.common.repeat {
                let ends_s = runs.last().map(|run| run.begins_s + run.duration_s());
                let begins_s = begins_s(lab.rig, run, repetition, ends_s)?;
                let planned = PlannedRun::new(lab, run, repetition, begins_s, seed ^ runs.len() as u64);
                planned.check(lab.step_s)?;
                sum.add(&planned, lab.step_s)?;
                if !names.insert(planned.name.clone()) {
                    return Err(ScenarioError::SameName { name: planned.name });
                }
                runs.push(planned);
            }
        }
        let timeline = Self { runs };
        if sum.rows == 0 { Err(ScenarioError::NoRun) } else { Ok(timeline) }
    }

    /// How many samples the campaign will have.
    #[must_use]
    pub fn rows(&self, step_s: f64) -> u64 {
        self.runs.iter().map(|run| run.rows(step_s)).sum()
    }

    /// Simulated time within runs, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.runs.iter().map(PlannedRun::duration_s).sum()
    }
}

/// What the runs so far ask for. Looked at with every run: what no memory holds must not be laid out first.
#[derive(Default)]
struct Sum {
    rows: u64,
    steps: u64,
    segments: usize,
}

impl Sum {
    fn add(&mut self, run: &PlannedRun, step_s: f64) -> Result<(), ScenarioError> {
        let steps = run.segments.iter().map(|segment| segment.steps(step_s)).fold(0, u64::saturating_add);
        self.rows = self.rows.saturating_add(run.rows(step_s));
        self.steps = self.steps.saturating_add(steps);
        self.segments += run.segments.len();
        if self.rows > MAX_ROWS {
            return Err(ScenarioError::TooManyRows { rows: self.rows, limit: MAX_ROWS });
        }
        if self.steps > MAX_STEPS {
            return Err(ScenarioError::TooManySteps { steps: self.steps, limit: MAX_STEPS });
        }
        if self.segments > MAX_SEGMENTS {
            return Err(ScenarioError::TooManyParts { parts: self.segments, limit: MAX_SEGMENTS });
        }
        Ok(())
    }
}

/// When a repetition begins: at its stated age, or one pause after what was before it.
fn begins_s(rig: &Rig, run: &Run, repetition: u32, ends_s: Option<f64>) -> Result<f64, ScenarioError> {
    let stated_days = run.common.age_days.filter(|_| repetition == 0);
    let Some(begins_days) = stated_days else {
        return Ok(ends_s.map_or(0.0, |ends_s| ends_s + rig.pause_h * 3600.0));
    };
    let begins_s = begins_days * DAY_S;
    match ends_s {
        Some(ends_s) if ends_s > begins_s => {
            Err(ScenarioError::Overlap { run: run.name(repetition), begins_days, ends_days: ends_s / DAY_S })
        }
        _ => Ok(begins_s),
    }
}

impl<'a> PlannedRun<'a> {
    fn new(lab: Lab<'_>, run: &'a Run, repetition: u32, begins_s: f64, seed: u64) -> Self {
        let mut programme = Programme::new(lab.device, lab.rig, run.common.mount_rotation_deg);
        run.kind.write(&mut programme, &mut Random::stream(seed, "order", 0));
        Self {
            name: run.name(repetition),
            run,
            begins_s,
            every: ((run.common.record_every_s / lab.step_s).round() as u64).max(1),
            segments: programme.segments(),
        }
    }

    /// How many samples it keeps.
    fn rows(&self, step_s: f64) -> u64 {
        let recorded = self.segments.iter().filter(|segment| segment.recorded);
        recorded.map(|segment| segment.steps(step_s) / self.every).fold(0, u64::saturating_add)
    }

    /// Length of the run, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.segments.iter().map(|segment| segment.duration_s).sum()
    }

    fn check(&self, step_s: f64) -> Result<(), ScenarioError> {
        let shortest = self.segments.iter().filter(|s| s.recorded).min_by_key(|s| s.steps(step_s));
        match shortest {
            Some(segment) if segment.steps(step_s) < self.every => {
                Err(ScenarioError::KeepsNothing { run: self.name.clone(), part_s: segment.duration_s })
            }
            _ => Ok(()),
        }
    }
}
