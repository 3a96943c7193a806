//! What each effect of a model is worth: the residual from the bare network up, one effect more on each rung.

use crate::campaign::{Campaign, Split};
use crate::compare::compare;
use crate::effect_choice::EffectChoice;
use crate::model::Model;
use crate::progress::Progress;
use crate::residuals::ResidualError;
use crate::train::{TrainError, TrainSettings, train};
use serde::Serialize;
use thiserror::Error;

/// One rung.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rung {
    /// What was added last.
    pub effect: String,
    /// Residual on the runs that the training never saw, µg RMS.
    pub residual_ug: f64,
}

/// What the lowest rung is called.
pub const BARE: &str = "network alone";

/// Why there is no ladder.
#[derive(Debug, Error)]
pub enum LadderError {
    /// A rung could not be trained.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// A rung could not be compared.
    #[error(transparent)]
    Residual(#[from] ResidualError),
}

/// The ladder of a model: the rungs below it are trained as it was, the top is the model itself.
///
/// # Errors
/// [`LadderError`] says which rung could not be made and why.
pub fn ladder(
    model: &Model,
    campaign: &Campaign,
    split: &Split,
    settings: &TrainSettings,
    progress: &dyn Progress,
) -> Result<Vec<Rung>, LadderError> {
    let effects = EffectChoice::of(model);
    let mut rungs = Vec::new();
    for count in 0..effects.len() {
        let settings = TrainSettings { effects: effects[..count].to_vec(), ..settings.clone() };
        let below = train(campaign, split, &settings, progress)?.model;
        rungs.push(rung(&effects, count, &below, campaign)?);
    }
    rungs.push(rung(&effects, effects.len(), model, campaign)?);
    Ok(rungs)
}

fn rung(effects: &[EffectChoice], count: usize, model: &Model, campaign: &Campaign) -> Result<Rung, ResidualError> {
    let effect = count.checked_sub(1).and_then(|last| effects.get(last)).map_or(BARE, EffectChoice::title).to_owned();
    Ok(Rung { effect, residual_ug: compare(model, campaign)?.residual_ug })
}
