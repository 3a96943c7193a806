//! Work that takes a while: what it tells meanwhile, and how it is stopped.

use serde::Serialize;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;
use trainer::ladder::Rung;
use trainer::progress::{Progress, RestartNews};

/// The steps of a calibration, as the page lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Step {
    Load,
    Train,
    Diagnose,
    Add,
    Verify,
    Plan,
}

/// Something that a page can draw while work goes on.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Report {
    /// Restarts begin.
    Begins { restarts: usize },
    /// One restart's curve goes on. Each curve has its own number; noise is what it can fall to.
    Restart { curve: usize, index: usize, iteration: usize, residual_ug: f64, noise_ug: Option<f64>, done: bool },
    /// A rung of the ladder is reached.
    Rung { effect: String, residual_ug: f64 },
    /// So much of it is done, 0 to 1.
    Done { share: f64 },
}

/// One piece of work.
pub struct Job {
    pub number: u64,
    pub step: Step,
    /// What it does, for people.
    pub what: String,
    /// The command line that does the same.
    pub command: String,
    stop: AtomicBool,
    told: Mutex<Told>,
    changed: watch::Sender<u64>,
}

#[derive(Default)]
struct Told {
    reports: Vec<Report>,
    /// Restart by restart the curve that it draws; none once it has ended.
    curves: HashMap<usize, usize>,
    drawn: usize,
}

impl Job {
    pub fn new(number: u64, step: Step, what: String, command: String, changed: watch::Sender<u64>) -> Self {
        Self { number, step, what, command, stop: AtomicBool::new(false), told: Mutex::default(), changed }
    }

    /// Asks it to end.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// What it told from this report on.
    pub fn reports(&self, from: usize) -> Vec<Report> {
        self.told().reports.get(from..).unwrap_or_default().to_vec()
    }

    pub fn rung(&self, rung: &Rung) {
        self.tell(Report::Rung { effect: rung.effect.clone(), residual_ug: rung.residual_ug });
    }

    pub fn done(&self, share: f64) {
        self.tell(Report::Done { share });
    }

    fn tell(&self, report: Report) {
        self.told().reports.push(report);
        self.changed.send_modify(|version| *version += 1);
    }

    fn told(&self) -> MutexGuard<'_, Told> {
        // What was told stays true if somebody panicked after telling it.
        self.told.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Job {
    fn begins(&self, restarts: usize) {
        self.told().curves.clear();
        self.tell(Report::Begins { restarts });
    }

    fn restart(&self, RestartNews { index, iteration, residual_g, noise_g, done }: RestartNews) {
        let mut told = self.told();
        let next = told.drawn;
        let curve = *told.curves.entry(index).or_insert(next);
        told.drawn = next.max(curve + 1);
        if done {
            told.curves.remove(&index);
        }
        drop(told);
        let (residual_ug, noise_ug) = (residual_g * 1e6, noise_g.map(|noise_g| noise_g * 1e6));
        self.tell(Report::Restart { curve, index, iteration, residual_ug, noise_ug, done });
    }

    fn cancelled(&self) -> bool {
        self.is_stopped()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_descent_has_a_curve_of_its_own() {
        let job = Job::new(1, Step::Train, String::new(), String::new(), watch::channel(0).0);
        let news = |index, iteration, done| RestartNews { index, iteration, residual_g: 1e-6, noise_g: None, done };
        job.begins(2);
        for (index, iteration, done) in [(0, 1, false), (1, 1, false), (0, 2, true), (0, 1, false), (1, 2, true)] {
            job.restart(news(index, iteration, done));
        }
        job.begins(2);
        job.restart(news(0, 1, false));
        let curves: Vec<usize> = job
            .reports(0)
            .iter()
            .filter_map(|report| if let Report::Restart { curve, .. } = report { Some(*curve) } else { None })
            .collect();
        assert_eq!(curves, [0, 1, 0, 2, 1, 3]);
        assert_eq!(job.reports(7).len(), 1);
    }
}
