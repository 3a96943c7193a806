//! From a campaign and a model to a problem.

use super::Problem;
use crate::campaign::Campaign;
use crate::diagnose::cells::Cells;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::forward::{EffectSet, Forward, StaticMap, SumChannel, basis};
use crate::diagnose::noise::NoiseModel;
use crate::diagnose::regression::compressed;
use crate::effect_choice::{EffectChoice, choose};
use crate::fit::dataset::InputScale;
use crate::model::Model;
use crate::yardstick::Yardstick;

/// What the campaign is measured with.
pub fn yardstick(model: &Model, campaign: &Campaign) -> Result<Yardstick, DiagnoseError> {
    Yardstick::of_model(model, campaign).ok_or(DiagnoseError::Numbers(UNUSABLE))
}

const UNUSABLE: &str = "references and readings are too large or too small for numbers: give them in another unit";

/// Model and measurements before the judge, in the units of `yardstick`, as `campaign` is.
pub fn problem<'a>(model: &Model, campaign: &'a Campaign, yardstick: &Yardstick) -> Result<Problem<'a>, DiagnoseError> {
    let map = StaticMap::new(model, yardstick);
    let max_gap_us = model.domain.max_gap_us;
    let cells = Cells::new(campaign, scale(model), max_gap_us, map.reach_g(), yardstick.gravity);
    let sample_ug = map.sample_ug(&cells).ok_or(DiagnoseError::NoNoise)?;
    let ug_per_c = map.ug_per_c(&cells);
    if !map.scale_factor_hz_per_g(&cells).is_finite() {
        return Err(DiagnoseError::Numbers(FLAT));
    }
    if !(sample_ug.is_finite() && ug_per_c.is_finite()) {
        return Err(DiagnoseError::Numbers(ABSURD));
    }
    let first_guess = NoiseModel::first_guess(sample_ug, ug_per_c);
    let basis = compressed(&cells, &first_guess, &basis::of_retraining(&map, &cells));
    let sum = SumChannel::new(&cells);
    Ok(Problem { forward: Forward::new(cells, map, sum), basis, sample_ug, ug_per_c })
}

/// A model without a slope explains every signal equally badly.
const FLAT: &str = "the model reads the same whatever the signal is: train it on a reference that varies, or state the \
                    scale factor";
const ABSURD: &str = "the residual is not a finite number: look at the campaign's extremes with `tempco inspect`";

/// From integers to the model's inputs.
pub fn scale(model: &Model) -> InputScale {
    InputScale {
        delta_f_zero_uhz: model.scaling.delta_f_zero_uhz,
        delta_f_half_span_hz: f64::from(model.scaling.delta_f_gain_per_hz).recip(),
        temperature_zero_uc: model.scaling.temperature_zero_uc,
        temperature_half_span_c: f64::from(model.scaling.temperature_gain_per_c).recip(),
    }
}

/// The effects that the model has already.
pub fn in_model(model: &Model, campaign: &Campaign, yardstick: &Yardstick) -> Result<EffectSet, DiagnoseError> {
    let runs: Vec<_> = campaign.runs.iter().collect();
    let mut known = EffectSet::NONE;
    for (choice, effect) in EffectChoice::of(model).iter().zip(&model.effects) {
        let chosen = choose(choice, campaign, &runs)?;
        let value = |name: &str, start: f64| effect.parameters.get(name).copied().unwrap_or(start);
        let values: Vec<f64> = chosen.about.parameters.iter().map(|about| value(about.name, about.start)).collect();
        known = known.with(&chosen, &yardstick.coefficients_inside(chosen.about, &values));
    }
    Ok(known)
}
