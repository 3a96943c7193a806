//! Training again as a model was trained: the same scale factor, seed, restarts, serial, effects, and the same runs held out.

use crate::campaign::{Campaign, CampaignError, HoldOut, Split};
use crate::effect_choice::EffectChoice;
use crate::model::{Model, Provenance};
use crate::train::TrainSettings;

/// The settings that made a model, with its effects to be fitted from where they are. Whatever made the network, effects
/// are fitted beside it with the second-order method.
#[must_use]
pub fn settings(model: &Model) -> TrainSettings {
    let Provenance { seed, restarts, scale_factor_hz_per_g, .. } = model.provenance;
    let (serial, effects) = (model.serial.clone(), EffectChoice::of(model));
    TrainSettings { restarts, scale_factor_hz_per_g, serial, effects, ..TrainSettings::new(seed) }
}

/// The runs that the model holds out, as far as the campaign has them; of a campaign that has none of them, the usual ones.
///
/// # Errors
/// If the campaign can't be divided so.
pub fn split(model: &Model, campaign: &Campaign) -> Result<Split, CampaignError> {
    let held_out = &model.provenance.held_out_runs;
    let known = |name: &&String| campaign.runs.iter().any(|run| run.name == **name);
    let names: Vec<String> = held_out.iter().filter(known).cloned().collect();
    campaign.split(&match names.as_slice() {
        [] if held_out.is_empty() => HoldOut::None,
        [] => HoldOut::LastOfEachKind,
        _ => HoldOut::Named(names),
    })
}
