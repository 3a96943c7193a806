//! Which physical effect a model lacks: named, or called ambiguous, absent or unknown.
//!
//! Layers; each looks down only:
//!
//! ```text
//! verdict                        the selection driver: one finding after the other, and the answer
//! design                         hypotheses, and the recording that would tell them apart
//! selection      lack_of_fit     every effect at every shape     structure that no effect makes
//! problem                        one campaign and one model: nuisances, noise, fits of parameters
//! regression                     least squares under a noise; variance components
//! noise                          components, Kalman filter, likelihood, initial states
//! forward                        static map, effects, sum of the frequencies; residuals and their derivatives
//! cells     answer     error     the campaign in cells           what is answered
//! ```
//!
//! `docs/diagnosis.md` tells how it works. `tests/layers.rs` holds the arrows.

mod answer;
mod cells;
mod design;
mod error;
#[cfg(test)]
mod example;
mod forward;
mod lack_of_fit;
mod noise;
mod problem;
mod regression;
mod selection;
mod thresholds;
mod verdict;

pub use answer::{
    Dependence, Diagnosis, Estimate, Finding, Judged, Noise, Outcome, Unexplained, Unobservable, Verdict,
};
pub use design::plan;
pub use error::DiagnoseError;
pub use thresholds::LEAST_DELTA_BIC;

use crate::campaign::Campaign;
use crate::compare::unseen;
use crate::effect_choice::EffectChoice;
use crate::model::Model;
use crate::progress::Progress;
use problem::yardstick;

/// Which physical effects `model` lacks, as far as `campaign` can tell.
///
/// Same model, same campaign: same answer, on any number of threads.
///
/// # Errors
/// [`DiagnoseError`] says what is missing.
pub fn diagnose(model: &Model, campaign: &Campaign, progress: &dyn Progress) -> Result<Diagnosis, DiagnoseError> {
    let yardstick = yardstick(model, campaign)?;
    let unseen: Vec<bool> = campaign.runs.iter().map(|run| unseen(model, campaign, run)).collect();
    let diagnosis = verdict::judge(model, &yardstick.campaign(campaign), &yardstick, &unseen, progress)?;
    Ok(diagnosis.converted(
        |size| yardstick.outside(size),
        |about, name, value| yardstick.coefficient_outside(about, name, value),
    ))
}

/// Where a joint fit of these effects should begin, judged beside a static `model` of the same campaign.
pub(crate) fn starts(model: &Model, campaign: &Campaign, choices: &[EffectChoice]) -> Option<Vec<EffectChoice>> {
    let yardstick = yardstick(model, campaign).ok()?;
    let choices = yardstick.choices_inside(choices);
    let started = selection::starts(model, &yardstick.campaign(campaign), &yardstick, &choices)?;
    Some(yardstick.choices_outside(&started))
}
