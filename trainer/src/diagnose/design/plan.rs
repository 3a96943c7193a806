//! The next recording: the one after which the surviving hypotheses would lie furthest apart.
//!
//! T-optimality (Atkinson & Fedorov 1975): a recording is worth the distance between what one hypothesis predicts and
//! the best that the other could make of it. The distance is that of the diagnosis: in units of the noise, after
//! everything that retraining, the effects found already and the other hypothesis' parameters can absorb, in the old
//! measurements and the new recording together.

use super::distance::{Predicted, distances};
use super::hypothesis::{fitted, typical};
use super::planned::joint;
use crate::campaign::Campaign;
use crate::diagnose::answer::Diagnosis;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::noise::from_reported;
use crate::diagnose::problem::{
    GlsPair, NoiseModels, Problem, fixed, free, in_model, initial_states, problem, sum_noise, yardstick,
};
use crate::diagnose::selection::with_channels;
use crate::diagnose::thresholds::{DECISIVE_SIGMA, LEAST_HOURS, LEAST_SIGMA2_PER_HOUR};
use crate::fit::effects::Chosen;
use crate::model::Model;
use crate::progress::Progress;
use crate::yardstick::Yardstick;
use firmware_core::effect::{self, About};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;
use thiserror::Error;

/// A recording that might be made: what chamber and turntable would do, row by row. Its frequencies don't matter.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Its name.
    pub name: String,
    /// The rows.
    pub campaign: Campaign,
    /// How long chamber and turntable are occupied, hours.
    pub hours: f64,
    /// How long it takes by the calendar, days.
    pub days: f64,
}

/// Which recording to make next.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Why these hypotheses.
    pub reason: Reason,
    /// What might be missing.
    pub hypotheses: Vec<Hypothesis>,
    /// How far apart they are in the measurements that exist.
    pub so_far: Vec<Separation>,
    /// Standard deviations beyond which the diagnosis names one and not the other.
    pub decisive_sigma: f64,
    /// The recordings, best first: those that decide more, then those that gain more in an hour.
    pub proposals: Vec<Proposal>,
}

/// Why these hypotheses are to be told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// They explain the measurements equally well.
    Ambiguous,
    /// The user named them.
    Asked,
    /// The measurements can't show them; nothing says that they are there.
    Unseen,
}

/// An effect that might be missing, as large as assumed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hypothesis {
    /// Its name.
    pub effect: String,
    /// Its parameters.
    pub parameters: BTreeMap<String, f64>,
    /// Whether they were fitted to the measurements; otherwise they are typical of such sensors.
    pub fitted: bool,
}

/// How far a hypothesis is from the best that another could do, or from no effect at all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Separation {
    /// The effect.
    pub effect: String,
    /// The other; none means no effect at all.
    pub from: Option<String>,
    /// Distance in standard deviations of the noise, the smaller one of both directions.
    pub sigma: f64,
}

/// A recording and what it would bring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Proposal {
    /// The recording's name.
    pub recording: String,
    /// How long chamber and turntable are occupied, hours.
    pub hours: f64,
    /// How long it takes by the calendar, days.
    pub days: f64,
    /// Each pair, old measurements and this recording together.
    pub separations: Vec<Separation>,
    /// The closest pair, standard deviations.
    pub sigma: f64,
    /// What it gains in an hour, over all pairs, σ².
    pub sigma2_per_hour: f64,
    /// Pairs that it decides and the measurements so far don't.
    pub decides: usize,
}

impl Proposal {
    /// Whether it is worth making.
    #[must_use]
    pub fn is_useful(&self) -> bool {
        self.sigma2_per_hour >= LEAST_SIGMA2_PER_HOUR
    }
}

/// Why there is no plan.
#[derive(Debug, Error)]
pub enum PlanError {
    /// Nothing is open.
    #[error("there is nothing to tell apart: the diagnosis is unambiguous, and the campaign shows every effect")]
    NothingOpen,
    /// No such effect.
    #[error("there is no effect named `{0}` that an instrument could take out; `tempco effects` lists them")]
    UnknownEffect(String),
    /// Chamber and turntable are for accelerometers.
    #[error(
        "the recordings are of chamber and turntable, but this campaign's reference is in {0}, which is no known unit of acceleration (g, mg, µg, ng, m/s2, mm/s2, Gal, mGal)"
    )]
    NoAccelerometer(String),
    /// The measurements don't allow a diagnosis.
    #[error(transparent)]
    Diagnose(#[from] DiagnoseError),
}

/// A hypothesis at its parameters, for computing.
struct Hypothetical {
    effect: Chosen,
    values: Vec<f64>,
    fitted: bool,
}

/// What the measurements say before anything is added.
struct Start {
    noises: NoiseModels,
    known: EffectSet,
    hypotheticals: Vec<Hypothetical>,
    pairs: Vec<(usize, Option<usize>)>,
}

/// Which of `recordings` tells best apart what `diagnosis` leaves open, or `effects` if any are named.
///
/// # Errors
/// [`PlanError`] says what is missing.
pub fn plan(
    model: &Model,
    campaign: &Campaign,
    diagnosis: &Diagnosis,
    effects: &[String],
    recordings: &[Recording],
    progress: &dyn Progress,
) -> Result<Plan, PlanError> {
    let yardstick = yardstick(model, campaign)?;
    // Recordings are laid out in g.
    let of_g = yardstick.of_g().ok_or_else(|| PlanError::NoAccelerometer(campaign.quantity.reference_unit.clone()))?;
    let (reason, names) = open(model, diagnosis, effects)?;
    let (campaign, diagnosis) = (&*yardstick.campaign(campaign), &inside(diagnosis, &yardstick));
    let old = problem(model, campaign, &yardstick)?;
    let start = Start::new(&old, (model, campaign, &yardstick), diagnosis, reason, &names)?;
    let so_far = start.measured(&old, &campaign.channels)?;
    let judged = |recording: &Recording| {
        if progress.cancelled() {
            return Err(DiagnoseError::Cancelled);
        }
        let joint = joint(model, campaign, &of_g.campaign(&recording.campaign), &yardstick);
        let mut new = problem(model, &joint, &yardstick)?;
        // The next training will know how coarsely the recording is sampled, and how long its pauses are.
        let cells = Arc::make_mut(&mut new.forward.cells);
        cells.max_gap_us = cells.max_gap_us.max(recording.campaign.max_gap_us());
        // Planned rows have no noise to estimate it from.
        new.sample_ug = old.sample_ug;
        if let (Some(new), Some(old)) = (&mut new.forward.sum, &old.forward.sum) {
            new.sample = old.sample;
        }
        Ok(start.proposal(recording, &so_far, &start.measured(&new, &joint.channels)?))
    };
    let mut proposals = recordings.par_iter().map(judged).collect::<Result<Vec<_>, DiagnoseError>>()?;
    proposals.sort_by(|a, b| (b.decides.cmp(&a.decides)).then(b.sigma2_per_hour.total_cmp(&a.sigma2_per_hour)));
    let hypotheses = start.hypotheticals.iter().map(|one| one.told(&yardstick)).collect();
    let so_far = start.named(&so_far);
    Ok(Plan { reason, hypotheses, so_far, decisive_sigma: DECISIVE_SIGMA, proposals })
}

/// What is to be told apart: what was asked, or what is ambiguous, or what can't be seen.
fn open(model: &Model, diagnosis: &Diagnosis, effects: &[String]) -> Result<(Reason, Vec<String>), PlanError> {
    if !effects.is_empty() {
        return Ok((Reason::Asked, effects.to_vec()));
    }
    if let Some(finding) = diagnosis.findings.iter().find(|finding| !finding.confounded_with.is_empty()) {
        let names = std::iter::once(&finding.effect).chain(&finding.confounded_with).cloned().collect();
        return Ok((Reason::Ambiguous, names));
    }
    // Of what the model has, training has seen enough, be it in another campaign.
    let is_known = |name: &str| model.effects.iter().any(|effect| effect.name == name);
    let is_open = |name: &&String| effect::about(name).is_some_and(About::is_on_device) && !is_known(name);
    let unseen: Vec<String> = diagnosis.unobservable.iter().map(|one| &one.effect).filter(is_open).cloned().collect();
    if unseen.is_empty() { Err(PlanError::NothingOpen) } else { Ok((Reason::Unseen, unseen)) }
}

impl Start {
    fn new(
        problem: &Problem,
        (model, campaign, yardstick): (&Model, &Campaign, &Yardstick),
        diagnosis: &Diagnosis,
        reason: Reason,
        names: &[String],
    ) -> Result<Self, PlanError> {
        let known = known((model, campaign, yardstick), diagnosis, names)?;
        let initial = initial_states(problem, &known);
        let (residuals, nuisance) = (problem.forward.residuals(&known), fixed(problem, &known));
        let noises = NoiseModels {
            delta: from_reported(&diagnosis.noise, problem.ug_per_c),
            sum: sum_noise(problem, &residuals, &nuisance, None, &initial),
            initial,
        };
        let shown = with_channels(campaign);
        let of_g = yardstick.of_g().unwrap_or(*yardstick);
        let usual = |about: &About| of_g.coefficients_inside(about, &typical(about));
        let hypothetical = |name: &String| {
            let about = effect::about(name).filter(|about| about.is_on_device() && !about.takes_program());
            let about = about.ok_or_else(|| PlanError::UnknownEffect(name.clone()))?;
            let shown = shown.iter().find(|chosen| chosen.about.id == about.id);
            let fit = shown.and_then(|effect| Some((effect, fitted(problem, &known, &noises, effect)?)));
            Ok(match fit {
                Some((effect, values)) => Hypothetical { effect: effect.clone(), values, fitted: true },
                None => Hypothetical { effect: Chosen::of(about), values: usual(about), fitted: false },
            })
        };
        let hypotheticals = names.iter().map(hypothetical).collect::<Result<Vec<_>, PlanError>>()?;
        let each = 0..hypotheticals.len();
        let pairs = if reason == Reason::Unseen || hypotheticals.len() == 1 {
            each.map(|one| (one, None)).collect()
        } else {
            each.flat_map(|one| (0..one).map(move |other| (other, Some(one)))).collect()
        };
        Ok(Self { noises, known, hypotheticals, pairs })
    }

    /// Squared distances of all pairs in these measurements, σ².
    fn measured(&self, problem: &Problem, channels: &[String]) -> Result<Vec<f64>, DiagnoseError> {
        let noises = self.noises.beside(&initial_states(problem, &self.known));
        let (residuals, nuisance) = (problem.forward.residuals(&self.known), free(problem, &self.known));
        let gls = GlsPair::new(problem, &residuals, &nuisance, &noises).ok_or(DiagnoseError::NoNoise)?;
        let predicted = |one: &Hypothetical| Some(Predicted::new(problem, &self.known, &one.among(channels)?));
        let predicted: Vec<Option<Predicted>> = self.hypotheticals.iter().map(predicted).collect();
        Ok(distances(&gls, &predicted, &self.pairs))
    }

    fn proposal(&self, recording: &Recording, so_far: &[f64], with: &[f64]) -> Proposal {
        let gained: f64 = with.iter().zip(so_far).map(|(with, without)| (with - without).max(0.0)).sum();
        let enough = DECISIVE_SIGMA.powi(2);
        let decisive = |(with, without): &(&f64, &f64)| **with >= enough && **without < enough;
        Proposal {
            recording: recording.name.clone(),
            hours: recording.hours,
            days: recording.days,
            separations: self.named(with),
            sigma: with.iter().copied().fold(f64::INFINITY, f64::min).sqrt(),
            sigma2_per_hour: gained / recording.hours.max(LEAST_HOURS),
            decides: with.iter().zip(so_far).filter(decisive).count(),
        }
    }

    fn named(&self, squares: &[f64]) -> Vec<Separation> {
        let name = |index: usize| self.hypotheticals[index].effect.about.name.to_owned();
        let of = |(&(one, other), square): (&(usize, Option<usize>), &f64)| Separation {
            effect: name(one),
            from: other.map(name),
            sigma: square.max(0.0).sqrt(),
        };
        self.pairs.iter().zip(squares).map(of).collect()
    }
}

impl Hypothetical {
    /// The hypothesis by itself; none if its channel is not among these.
    fn among(&self, channels: &[String]) -> Option<EffectSet> {
        let channel = match self.effect.about.channel {
            Some(name) => channels.iter().position(|channel| channel == name)?,
            None => 0,
        };
        Some(EffectSet::NONE.with(&Chosen { channel, ..self.effect.clone() }, &self.values))
    }

    fn told(&self, yardstick: &Yardstick) -> Hypothesis {
        let about = self.effect.about;
        let pairs = about.parameters.iter().zip(yardstick.coefficients_outside(about, &self.values));
        let free = pairs.filter(|(parameter, _)| parameter.role != effect::Role::Origin);
        let parameters = free.map(|(parameter, value)| (parameter.name.to_owned(), value)).collect();
        Hypothesis { effect: about.name.to_owned(), parameters, fitted: self.fitted }
    }
}

/// What is in the model and what was found beside the hypotheses.
fn known(
    (model, campaign, yardstick): (&Model, &Campaign, &Yardstick),
    diagnosis: &Diagnosis,
    names: &[String],
) -> Result<EffectSet, DiagnoseError> {
    let is_open = |name: &str| names.iter().any(|other| other == name);
    let mut known = in_model(model, campaign, yardstick)?;
    while let Some(index) = known.effects.iter().position(|effect| is_open(effect.about.name)) {
        known = known.without(index);
    }
    let shown = with_channels(campaign);
    for finding in diagnosis.findings.iter().filter(|finding| !is_open(&finding.effect)) {
        let Some(effect) = shown.iter().find(|chosen| chosen.about.name == finding.effect) else { continue };
        let value = |about: &effect::Parameter| match finding.parameters.get(about.name) {
            Some(estimate) => estimate.value,
            None => effect.origin,
        };
        known = known.with(effect, &effect.about.parameters.iter().map(value).collect::<Vec<_>>());
    }
    Ok(known)
}

/// A diagnosis in the units of the work.
fn inside(diagnosis: &Diagnosis, yardstick: &Yardstick) -> Diagnosis {
    let coefficient = |about: &About, name: &str, value: f64| yardstick.coefficient_inside(about, name, value);
    diagnosis.clone().converted(|size| yardstick.inside(size), coefficient)
}
