//! Which physical effect a model lacks: named, or called ambiguous, absent or unknown.
//!
//! ```text
//! layout      the campaign in cells            instrument   residuals, and what retraining could change
//! whitening   noise and its filter             sum_channel  the sum of the frequencies as a second witness
//! noise_search its sizes                       candidate    every effect at every shape
//!      └──────────── evidence: the score test ─────────────┘
//!                        case: one campaign and one model, together
//!          observable ─▶ search ─▶ judge ─▶ answer     held_out, dependence, telltale, period, separation
//!                            plan: hypothesis, planned, distance
//! ```
//!
//! `docs/diagnosis.md` tells how it works.

mod abreast;
mod answer;
mod beginning;
mod candidate;
mod case;
mod dependence;
mod distance;
mod evidence;
mod filter;
mod gathered;
mod held_out;
mod hypothesis;
mod instrument;
mod judge;
mod layout;
mod left;
mod noise_search;
mod observable;
mod period;
pub mod plan;
mod planned;
mod refit;
mod search;
mod separation;
mod sum_channel;
mod suspect;
mod telltale;
mod whitening;

pub use answer::{Dependence, Diagnosis, Estimate, Finding, Noise, Unexplained, Unobservable, Verdict};

use crate::campaign::Campaign;
use crate::effect_choice::{EffectChoice, EffectError};
use crate::model::Model;
use crate::progress::Progress;
use crate::yardstick::Yardstick;
use thiserror::Error;

/// Why there is no diagnosis.
#[derive(Debug, Error)]
pub enum DiagnoseError {
    /// Stopped.
    #[error("cancelled")]
    Cancelled,
    /// The residual's noise can't be told.
    #[error("the noise can't be told from these measurements: no two neighbouring rows share a position")]
    NoNoise,
    /// The numbers lead nowhere.
    #[error("{0}")]
    Numbers(&'static str),
    /// The campaign lacks what the model's effects follow.
    #[error(transparent)]
    Effect(#[from] EffectError),
}

/// Which physical effects `model` lacks, as far as `campaign` can tell.
///
/// Same model, same campaign: same answer, on any number of threads.
///
/// # Errors
/// [`DiagnoseError`] says what is missing.
pub fn diagnose(model: &Model, campaign: &Campaign, progress: &dyn Progress) -> Result<Diagnosis, DiagnoseError> {
    let yardstick = yardstick(model, campaign)?;
    let diagnosis = judge::judge(model, &yardstick.campaign(campaign), &yardstick, progress)?;
    Ok(diagnosis.converted(
        |size| yardstick.outside(size),
        |about, name, value| yardstick.coefficient_outside(about, name, value),
    ))
}

fn yardstick(model: &Model, campaign: &Campaign) -> Result<Yardstick, DiagnoseError> {
    Yardstick::of_model(model, campaign).ok_or(DiagnoseError::Numbers(UNUSABLE))
}

const UNUSABLE: &str = "references and readings are too large or too small for numbers: give them in another unit";

/// Where a joint fit of these effects should begin, judged beside a static `model` of the same campaign.
pub(crate) fn starts(model: &Model, campaign: &Campaign, choices: &[EffectChoice]) -> Option<Vec<EffectChoice>> {
    let yardstick = yardstick(model, campaign).ok()?;
    let choices = yardstick.choices_inside(choices);
    let started = judge::starts(model, &yardstick.campaign(campaign), &yardstick, &choices)?;
    Some(yardstick.choices_outside(&started))
}
