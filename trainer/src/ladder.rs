//! What each effect of a model is worth: the residual from the bare network up, one effect more on each rung.

use crate::campaign::{Campaign, Split};
use crate::compare::compare;
use crate::effect_choice::EffectChoice;
use crate::fit::at_bound::at_bound;
use crate::model::Model;
use crate::progress::Progress;
use crate::residuals::ResidualError;
use crate::train::{TrainError, TrainSettings, train};
use firmware_core::effect::{Role, about};
use serde::Serialize;
use std::ops::RangeInclusive;
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

/// What speaks against the effect that was added last, each a sentence: the held-out residual did not fall, or a coefficient
/// was stopped by its bound. Nothing where it does its work, or where the model has no effect.
#[must_use]
pub fn doubts(model: &Model, campaign: &Campaign, rungs: &[Rung]) -> Vec<String> {
    let temperatures_c = || campaign.rows().map(|row| f64::from(row.sample.temperature_uc) * 1e-6);
    let range_c = temperatures_c().fold(f64::INFINITY, f64::min)..=temperatures_c().fold(f64::NEG_INFINITY, f64::max);
    doubts_within(&range_c, model, rungs)
}

fn doubts_within(range_c: &RangeInclusive<f64>, model: &Model, rungs: &[Rung]) -> Vec<String> {
    let rise = match rungs {
        [.., before, last] if last.residual_ug >= before.residual_ug => Some(format!(
            "with {} the held-out residual does not fall, but goes from {:.2} to {:.2} µg: it is not what is missing, or \
             this campaign does not determine it",
            last.effect, before.residual_ug, last.residual_ug
        )),
        _ => None,
    };
    rise.into_iter().chain(stopped(range_c, model)).collect()
}

fn stopped(range_c: &RangeInclusive<f64>, model: &Model) -> Option<String> {
    let effect = model.effects.last()?;
    let values = effect.coefficients(&model.channels).ok()?;
    let parameter = at_bound(about(&effect.name)?, &values, range_c)?;
    let value = effect.parameters.get(parameter.name)?;
    let ended = if parameter.role == Role::Shape { "ended at its bound" } else { "ended where nothing was measured" };
    Some(format!(
        "{} of {} {ended}, {value:.4} {}: the measurements want something else",
        parameter.name,
        effect.title(),
        parameter.unit
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::ModelEffect;
    use crate::model::example::model;

    fn with(name: &str, values: &[f64], residuals_ug: &[f64]) -> Vec<String> {
        let parameters = about(name).unwrap().parameters.iter().map(|parameter| parameter.name.to_owned());
        let effect = ModelEffect {
            name: name.to_owned(),
            channel: None,
            expression: None,
            parameters: parameters.zip(values.iter().copied()).collect(),
        };
        let model = Model { effects: vec![effect], ..model() };
        let rung = |(place, residual_ug): (usize, &f64)| Rung { effect: format!("{place}"), residual_ug: *residual_ug };
        doubts_within(&(-10.0..=50.0), &model, &residuals_ug.iter().enumerate().map(rung).collect::<Vec<_>>())
    }

    #[test]
    fn an_effect_that_does_not_lower_the_residual_or_was_stopped_is_doubtful_and_others_are_not() {
        assert_eq!(with("warm-up", &[1e-4, 600.0], &[30.0, 20.0, 10.0]), Vec::<String>::new());
        let [rise] = &with("warm-up", &[1e-4, 600.0], &[30.0, 10.0, 10.0])[..] else { panic!() };
        assert!(
            rise.starts_with("with 2 the held-out residual does not fall, but goes from 10.00 to 10.00 µg"),
            "{rise}"
        );
        let [bound] = &with("warm-up", &[1e-4, 36_000.0], &[30.0, 20.0])[..] else { panic!() };
        assert!(bound.starts_with("tau_s of warm-up ended at its bound, 36000.0000 s"), "{bound}");
        let [place] = &with("mode-crossing", &[1e-4, 2.0, 300.0, 0.0], &[30.0, 20.0])[..] else { panic!() };
        assert!(place.contains("ended where nothing was measured, 300.0000 °C"), "{place}");
        assert_eq!(with("warm-up", &[1e-4, 36_000.0], &[30.0, 30.0]).len(), 2);
    }
}
