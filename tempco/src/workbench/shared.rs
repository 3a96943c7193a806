//! What all requests share: the session behind a lock, one piece of work at a time, and a bell that rings on news.

use super::job::{Job, Step};
use super::refusal::Refusal;
use super::session::{Refused, Session};
use crate::failure::Failure;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// The workbench.
pub struct Shared {
    session: Mutex<Session>,
    changed: watch::Sender<u64>,
}

/// What is to be done with the session, and with files, once work has ended that nobody stopped.
pub type Finish = Box<dyn FnOnce(&mut Session) -> Result<(), Failure> + Send>;

/// What a thread does; it may look whether it is to stop, and tell how far it is.
pub type Work = Box<dyn FnOnce(&Job) -> Result<Finish, Failure> + Send>;

/// Work to be done on a thread of its own.
pub struct Task {
    pub step: Step,
    pub what: String,
    pub command: String,
    pub work: Work,
}

impl Shared {
    pub fn new(folder: PathBuf) -> Self {
        Self { session: Mutex::new(Session::new(folder)), changed: watch::channel(0).0 }
    }

    /// Rings at every change.
    pub fn bell(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    pub fn session(&self) -> MutexGuard<'_, Session> {
        // Changes are made by assignments: no panic leaves half of one behind.
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the session and rings.
    pub fn change<T>(&self, change: impl FnOnce(&mut Session) -> T) -> T {
        let mut session = self.session();
        session.version += 1;
        let answer = change(&mut session);
        drop(session);
        self.changed.send_modify(|version| *version += 1);
        answer
    }

    /// Starts work; refuses while other work goes on.
    pub fn start(self: &Arc<Self>, task: Task) -> Result<(), Refusal> {
        let Task { step, what, command, work } = task;
        let mut session = self.session();
        session.idle()?;
        let job = Arc::new(Job::new(session.next_job(), step, what, command, self.changed.clone()));
        session.begin(Arc::clone(&job));
        drop(session);
        self.changed.send_modify(|version| *version += 1);
        let shared = Arc::clone(self);
        std::thread::spawn(move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| work(&job))).unwrap_or_else(|_| Err(fault()));
            shared.change(|session| conclude(session, &job, outcome));
        });
        Ok(())
    }
}

/// What stopped work found is thrown away: nothing in a session is without a command line that gives the same.
fn conclude(session: &mut Session, job: &Job, outcome: Result<Finish, Failure>) {
    session.end();
    if job.is_stopped() {
        session.stopped = Some(job.step);
    } else if let Err(failure) = outcome.and_then(|finish| finish(session)) {
        session.refused = Some(Refused { step: job.step, failure });
    }
}

fn fault() -> Failure {
    Failure::new("a fault in the program ended this; the terminal shows where")
        .help("everything that was there before is still there; please report it")
}
