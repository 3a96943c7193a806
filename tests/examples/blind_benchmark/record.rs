//! What is kept of one campaign, and the line that `--verbose` prints of it.

use crate::after_add::AfterAdd;
use crate::case::Case;
use crate::judge::{Judgement, Outcome};
use crate::options::{Class, Protocol};
use serde::Serialize;
use std::fmt;
use trainer::diagnose::{Diagnosis, Finding};

/// One campaign's result.
#[derive(Debug, Serialize)]
pub struct Record {
    pub protocol: &'static str,
    pub class: &'static str,
    pub index: usize,
    pub seed: u64,
    pub rig: bool,
    pub hidden: Vec<HiddenRecord>,
    pub rows: usize,
    pub sample_ug: f64,
    /// Of the diagnosis alone.
    pub seconds: f64,
    pub judgement: Option<Judgement>,
    pub after_add: Option<AfterAdd>,
    /// Why nothing could be hidden.
    pub skipped: Option<String>,
    /// Why there is no diagnosis.
    pub error: Option<String>,
    pub diagnosis: Option<Diagnosis>,
}

/// A hidden effect and how much of it can be seen, in units of the noise of a sample.
#[derive(Debug, Serialize)]
pub struct HiddenRecord {
    pub name: String,
    pub times_noise: f64,
    /// The figure that counts.
    pub visible_sigma: f64,
    pub static_sigma: f64,
    pub within_runs_sigma: f64,
    pub within_mountings_sigma: f64,
}

impl Record {
    fn new(case: &Case, seconds: f64) -> Self {
        let hidden = |hidden: &crate::case::Hidden| HiddenRecord {
            name: hidden.name.clone(),
            times_noise: hidden.times_noise,
            visible_sigma: case.visible_sigma(hidden),
            static_sigma: hidden.visible.static_ug / case.sample_ug,
            within_runs_sigma: hidden.visible.within_runs_ug / case.sample_ug,
            within_mountings_sigma: hidden.visible.within_mountings_ug / case.sample_ug,
        };
        Self {
            seed: case.seed,
            rig: case.rig,
            hidden: case.hidden.iter().map(hidden).collect(),
            rows: case.campaign.row_count(),
            sample_ug: case.sample_ug,
            seconds,
            skipped: None,
            ..Self::skipped(case.protocol, case.class, case.index, String::new())
        }
    }

    pub fn skipped(protocol: Protocol, class: Class, index: usize, reason: String) -> Self {
        Self {
            protocol: protocol.name(),
            class: class.name(),
            index,
            seed: 0,
            rig: false,
            hidden: Vec::new(),
            rows: 0,
            sample_ug: 0.0,
            seconds: 0.0,
            judgement: None,
            after_add: None,
            skipped: Some(reason),
            error: None,
            diagnosis: None,
        }
    }

    pub fn failed(case: &Case, seconds: f64, error: String) -> Self {
        Self { error: Some(error), ..Self::new(case, seconds) }
    }

    pub fn judged(
        case: &Case,
        seconds: f64,
        diagnosis: Diagnosis,
        judgement: Judgement,
        after_add: Option<AfterAdd>,
    ) -> Self {
        Self { diagnosis: Some(diagnosis), judgement: Some(judgement), after_add, ..Self::new(case, seconds) }
    }

    /// Whether the answer is what an honest judge of this campaign would say.
    fn is_right(&self, judgement: &Judgement) -> bool {
        match self.class {
            "none" => judgement.outcome == Outcome::Nothing,
            "outside" => judgement.outcome == Outcome::Unexplained,
            "pair" => judgement.all_found,
            _ => judgement.named || judgement.in_set,
        }
    }

    /// Whether every hidden effect can be seen above the noise of a sample.
    pub fn is_visible(&self) -> bool {
        self.hidden.iter().all(|hidden| hidden.visible_sigma >= 1.0)
    }
}

impl fmt::Display for Record {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.protocol, self.class, self.index)?;
        if let Some(reason) = &self.skipped {
            return write!(f, " skipped: {reason}");
        }
        write!(f, " seed {}{} | truth", self.seed, if self.rig { " rig" } else { "" })?;
        for hidden in &self.hidden {
            write!(f, " {} {:.2}σ", hidden.name, hidden.visible_sigma)?;
            if self.rig {
                write!(f, " (static {:.2}, runs {:.2})", hidden.static_sigma, hidden.within_runs_sigma)?;
            }
        }
        if self.hidden.is_empty() {
            write!(f, " nothing")?;
        }
        if let Some(error) = &self.error {
            return write!(f, " | error: {error}");
        }
        if let (Some(diagnosis), Some(judgement)) = (&self.diagnosis, &self.judgement) {
            let right = if self.is_right(judgement) { "ok" } else { "NOT" };
            write!(f, " | {right} {:?} | ", judgement.outcome)?;
            write_answer(f, diagnosis, judgement)?;
        }
        if let Some(after_add) = &self.after_add {
            write!(f, " | added {:.2} µg, truth {:.2} µg", after_add.found_ug, after_add.true_ug)?;
        }
        write!(f, " | {:.1} s", self.seconds)
    }
}

fn write_answer(f: &mut fmt::Formatter<'_>, diagnosis: &Diagnosis, judgement: &Judgement) -> fmt::Result {
    let Diagnosis { verdict, residual_ug, residual_after_ug, noise_floor_ug, .. } = diagnosis;
    write!(f, "{verdict:?} {residual_ug:.2} → {residual_after_ug:.2} µg (noise {noise_floor_ug:.2})")?;
    for finding in &diagnosis.findings {
        write!(f, "; {}", finding_words(finding))?;
    }
    if let Some(unexplained) = &diagnosis.unexplained {
        write!(f, "; unexplained {:.2} µg on {}", unexplained.residual_ug, unexplained.depends_on.join(", "))?;
    }
    if !judgement.additions.is_empty() {
        write!(f, " | false: {}", judgement.additions.join(", "))?;
    }
    Ok(())
}

fn finding_words(finding: &Finding) -> String {
    let Finding { effect, delta_bic, residual_before_ug, residual_after_ug, confounded_with, parameters, .. } = finding;
    let parameters: Vec<String> = parameters
        .iter()
        .map(|(name, estimate)| format!("{name}={:.3e}±{:.1e}", estimate.value, estimate.sigma))
        .collect();
    let mut words = format!("{effect} ΔBIC {delta_bic:.0} {residual_before_ug:.2}→{residual_after_ug:.2}");
    if !parameters.is_empty() {
        words += &format!(" [{}]", parameters.join(" "));
    }
    if !confounded_with.is_empty() {
        words += &format!(" or {}", confounded_with.join("/"));
    }
    words
}
