//! Which runs teach and which judge: always whole runs, never samples of one.
//!
//! Neighbouring samples share their noise, lag and drift. A model judged on samples of the runs that it was
//! fitted to looks better than it is.

use super::Campaign;
use super::error::{CampaignError, Facts, Place, list};
use super::nearest::nearest;
use std::collections::HashMap;
use std::fmt;

/// What to keep from training.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum HoldOut {
    /// The last run of each kind that has at least two; if no kind has, the last run.
    #[default]
    LastOfEachKind,
    /// The runs of these names.
    Named(Vec<String>),
    /// Nothing: every figure is then of the data that the model has seen.
    None,
}

/// Positions in [`Campaign::runs`], ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    /// Runs that the model is fitted to.
    pub training: Vec<usize>,
    /// Runs that it is judged on.
    pub held_out: Vec<usize>,
    /// Why these; its `Display` is a sentence for the report.
    pub basis: Basis,
}

/// What decided a split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// The last run of each kind that has at least two.
    LastOfEachKind,
    /// The last run of all, because no kind has two.
    LastRun,
    /// The caller named the runs.
    Named,
    /// Nothing is held out.
    Nothing,
}

impl fmt::Display for Basis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LastOfEachKind => "the last run of each kind that has two or more is held out",
            Self::LastRun => "no kind has two runs, so the last run is held out",
            Self::Named => "the named runs are held out",
            Self::Nothing => "nothing is held out: the figures are of data that the model has seen",
        })
    }
}

impl Campaign {
    /// Divides the runs into those that teach and those that judge.
    ///
    /// # Errors
    /// [`CampaignError::UnknownRun`] for a name that no run has, [`CampaignError::NothingLeft`] if no run
    /// would remain for training, [`CampaignError::OneRun`] if there is only one and nobody named it.
    pub fn split(&self, hold_out: &HoldOut) -> Result<Split, CampaignError> {
        match hold_out {
            HoldOut::None => Ok(self.divided(&[], Basis::Nothing)),
            HoldOut::Named(names) => {
                let held_out = names.iter().map(|name| self.run_index(name)).collect::<Result<Vec<_>, _>>()?;
                let split = self.divided(&held_out, Basis::Named);
                if split.training.is_empty() { Err(nothing_left(names)) } else { Ok(split) }
            }
            HoldOut::LastOfEachKind if self.runs.len() < 2 => Err(self.one_run()),
            HoldOut::LastOfEachKind => match self.last_of_each_kind().as_slice() {
                [] => Ok(self.divided(&[self.runs.len() - 1], Basis::LastRun)),
                held_out => Ok(self.divided(held_out, Basis::LastOfEachKind)),
            },
        }
    }

    fn divided(&self, held_out: &[usize], basis: Basis) -> Split {
        let (held_out, training) = (0..self.runs.len()).partition(|position| held_out.contains(position));
        Split { training, held_out, basis }
    }

    fn run_index(&self, name: &str) -> Result<usize, CampaignError> {
        self.runs.iter().position(|run| run.name == name).ok_or_else(|| {
            let names: Vec<String> = self.runs.iter().map(|run| run.name.clone()).collect();
            let facts = Facts::boxed(Place::campaign(), list("runs", &names), format!("a run {name} to hold out"));
            CampaignError::UnknownRun { facts, nearest: nearest(name, &names) }
        })
    }

    fn last_of_each_kind(&self) -> Vec<usize> {
        let mut kinds: HashMap<&str, (usize, usize)> = HashMap::new();
        for (position, run) in self.runs.iter().enumerate() {
            let (count, last) = kinds.entry(run.kind.as_str()).or_default();
            (*count, *last) = (*count + 1, position);
        }
        kinds.into_values().filter(|(count, _)| *count > 1).map(|(_, last)| last).collect()
    }
}

fn nothing_left(names: &[String]) -> CampaignError {
    let facts = Facts::boxed(Place::campaign(), list("nothing but", names), "a run to train on besides those held out");
    CampaignError::NothingLeft(facts)
}

#[cfg(test)]
mod tests {
    use super::super::{Quantity, Run, UNSTATED};
    use super::*;

    fn campaign(kinds: &[&str]) -> Campaign {
        let run = |(number, kind): (usize, &&str)| Run {
            name: format!("run-{number}"),
            kind: (*kind).to_owned(),
            source: "campaign.csv".into(),
            rows: Vec::new(),
        };
        Campaign::new(kinds.iter().enumerate().map(run).collect(), Vec::new(), Quantity::default())
    }

    fn named(names: &[&str]) -> HoldOut {
        HoldOut::Named(names.iter().map(|&name| name.to_owned()).collect())
    }

    #[test]
    fn whole_runs_are_held_out() {
        for (kinds, hold_out, held_out, basis) in [
            (&["full", "ramp", "full", "ramp", "zero"][..], HoldOut::default(), &[2, 3][..], Basis::LastOfEachKind),
            (&[UNSTATED, UNSTATED, UNSTATED], HoldOut::LastOfEachKind, &[2], Basis::LastOfEachKind),
            (&["full", "ramp", "zero"], HoldOut::LastOfEachKind, &[2], Basis::LastRun),
            (&["full", "ramp", "zero"], named(&["run-1", "run-0", "run-1"]), &[0, 1], Basis::Named),
            (&["full", "ramp"], HoldOut::LastOfEachKind, &[1], Basis::LastRun),
            (&["full", "full"], HoldOut::None, &[], Basis::Nothing),
            (&["full"], HoldOut::None, &[], Basis::Nothing),
        ] {
            let split = campaign(kinds).split(&hold_out).expect("a split");
            assert_eq!((split.held_out.as_slice(), split.basis), (held_out, basis), "{kinds:?}");
            let training: Vec<usize> = (0..kinds.len()).filter(|position| !held_out.contains(position)).collect();
            assert_eq!(split.training, training, "{kinds:?}");
        }
    }
}
