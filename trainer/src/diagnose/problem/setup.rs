//! From a campaign and a model to a problem.

use super::Problem;
use crate::campaign::Campaign;
use crate::diagnose::cells::Cells;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::forward::{EffectSet, Forward, StaticMap, SumChannel};
use crate::diagnose::noise::NoiseModel;
use crate::diagnose::regression::directions;
use crate::effect_choice::{EffectChoice, choose};
use crate::fit::dataset::InputScale;
use crate::model::Model;
use crate::yardstick::Yardstick;
use std::sync::Arc;

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
    let map = map.of_still(cells.is_still());
    let ug_per_c = map.ug_per_c(&cells);
    if !map.scale_factor_hz_per_g(&cells).is_finite() {
        return Err(DiagnoseError::Numbers(FLAT));
    }
    let sum = SumChannel::new(&cells);
    let forward = Forward::new(Arc::new(cells), map, sum);
    let sample_ug = forward.sample_ug(&EffectSet::NONE).ok_or(DiagnoseError::NoNoise)?;
    if !(sample_ug.is_finite() && ug_per_c.is_finite()) {
        return Err(DiagnoseError::Numbers(ABSURD));
    }
    let inputs = forward.inputs(&EffectSet::NONE);
    let all = forward.retraining(&inputs);
    let directions = directions(&forward.cells, &NoiseModel::first_guess(sample_ug, ug_per_c), &all);
    let basis = all.iter().map(|run| run * &directions).collect();
    Ok(Problem { forward, basis, directions, sample_ug, ug_per_c, inputs, unseen: None })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::cells::width;
    use crate::diagnose::example::{self, RANGE_C, Recipe, SUM_HZ_PER_C};
    use crate::diagnose::problem::in_model;
    use crate::model::ModelEffect;

    fn refused(model: &Model, campaign: &Campaign) -> Option<DiagnoseError> {
        let yardstick = yardstick(model, campaign).unwrap();
        problem(model, &yardstick.campaign(campaign), &yardstick).err()
    }

    #[test]
    fn the_models_integers_and_units_are_taken_over() {
        let campaign = Recipe { sum: true, ..Recipe::default() }.campaign();
        let problem = example::problem(&campaign);
        let scale = scale(&example::model());
        assert_eq!((scale.delta_f_half_span_hz, scale.temperature_half_span_c), (512.0, 32.0));
        let range_c = problem.cells().range_c();
        assert!((range_c.start() - RANGE_C.0).abs() < 1e-6 && (range_c.end() - RANGE_C.1).abs() < 1e-6, "{range_c:?}");
        let per_c = problem.forward.sum.as_ref().unwrap().per_c;
        assert!((per_c / (SUM_HZ_PER_C.abs() * 1e3) - 1.0).abs() < 1e-3, "{per_c}");
        // The network's output weights are nothing, so only polynomials and outputs are left, and fewer than all.
        assert!((20..50).contains(&width(&problem.basis)), "{}", width(&problem.basis));
    }

    #[test]
    fn a_model_without_a_slope_is_refused_as_flat() {
        let mut model = example::model();
        model.scaling.line_g = [0.0, 0.0, 1.0 / 32.0, 0.0];
        let found = refused(&model, &Recipe::default().campaign());
        assert!(matches!(found, Some(DiagnoseError::Numbers(FLAT))), "{found:?}");
    }

    #[test]
    fn a_campaign_of_single_rows_tells_of_no_noise() {
        let found = refused(&example::model(), &Recipe { rows: 1, ..Recipe::default() }.campaign());
        assert!(matches!(found, Some(DiagnoseError::NoNoise)), "{found:?}");
    }

    #[test]
    fn the_effects_of_a_model_are_known_with_their_values_and_one_that_is_not_there_is_an_error() {
        let campaign = Recipe::default().campaign();
        let mut model = example::model();
        let effect = |name: &str, parameters: &[(&str, f64)]| ModelEffect {
            name: name.to_owned(),
            channel: None,
            expression: None,
            parameters: parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
        };
        model.effects = vec![effect("warm-up", &[("amplitude_g", 2e-4), ("tau_s", 500.0)])];
        let yardstick = yardstick(&model, &campaign).unwrap();
        let known = in_model(&model, &campaign, &yardstick).unwrap();
        assert_eq!(known.coefficients.values, [[2e-4, 500.0]]);
        model.effects = vec![effect("supply-voltage", &[("bias_g_per_v", 1e-3), ("nominal_v", 5.0)])];
        assert!(in_model(&model, &campaign, &yardstick).is_err());
    }
}
