//! What effects leave of the residual and of the sum of the frequencies.

use super::contributions::{Contributions, contributions};
use super::effect_set::EffectSet;
use super::static_map::StaticMap;
use super::sum_channel::SumChannel;
use crate::diagnose::cells::{Cells, Columns};

/// What effects leave.
#[derive(Clone)]
pub struct CellResiduals {
    /// Reading minus reference, µg: of each run cells × 1.
    pub delta: Columns,
    /// Sum of the frequencies minus its map, mHz: of each run cells × 1.
    pub sum: Option<Columns>,
}

/// Effects whose contributions don't change while others are fitted.
#[derive(Clone)]
pub struct FixedEffects {
    contributions: Contributions,
    /// Of those that predict the sum.
    predicted: Contributions,
    /// What they leave by themselves.
    residuals: CellResiduals,
}

impl FixedEffects {
    /// These effects.
    pub fn new(cells: &Cells, map: &StaticMap, sum: Option<&SumChannel>, set: &EffectSet) -> Self {
        let (all, predicted) = (contributions(cells, set), contributions(cells, &set.sum_predicted()));
        let delta = map.residual_ug(cells, &all);
        let sum = sum.map(|channel| channel.residual_under(cells, &[&predicted]));
        Self { contributions: all, predicted, residuals: CellResiduals { delta, sum } }
    }
}

/// What these effects leave together with those that are fixed.
pub fn residuals_beside(
    cells: &Cells,
    map: &StaticMap,
    sum: Option<&SumChannel>,
    fixed: &FixedEffects,
    set: &EffectSet,
) -> CellResiduals {
    let own = contributions(cells, set);
    let delta = map.residual_beside_ug(cells, &fixed.contributions, &fixed.residuals.delta, &own);
    let predicted = set.sum_predicted();
    let sum = match sum {
        Some(channel) if !predicted.effects.is_empty() => {
            let all_predicted = predicted.effects.len() == set.effects.len();
            let own = if all_predicted { own } else { contributions(cells, &predicted) };
            Some(channel.residual_under(cells, &[&fixed.predicted, &own]))
        }
        _ => fixed.residuals.sum.clone(),
    };
    CellResiduals { delta, sum }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, disturbed, effect, problem};

    #[test]
    fn effects_that_are_taken_out_leave_what_there_was_without_them() {
        let still = Recipe::default().campaign();
        for (name, values) in [
            ("thermal-lag", vec![60.0]),
            ("thermal-gradient", vec![5e-3, 8.0]),
            ("thermal-hysteresis", vec![1e-5, 6.0]),
            ("warm-up", vec![3e-4, 700.0]),
        ] {
            let set = EffectSet::NONE.with(&effect(name, &still), &values);
            let campaign = disturbed(still.clone(), &set);
            let [before, after] = [(&still, &EffectSet::NONE), (&campaign, &set)]
                .map(|(campaign, set)| problem(campaign).forward.residuals(set).delta);
            let raw = problem(&campaign).forward.residuals(&EffectSet::NONE).delta;
            let away = |one: &Columns| one.iter().zip(&before).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
            // Numbers are rounded to a µHz, which is 2.4 ng.
            assert!(away(&after) < 0.01 && away(&raw) > 20.0, "{name}: {} {}", away(&after), away(&raw));
        }
    }

    #[test]
    fn fixed_effects_and_others_leave_what_all_of_them_leave() {
        let campaign = Recipe { sum: true, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let one = |name: &str, values: &[f64]| EffectSet::NONE.with(&effect(name, &campaign), values);
        let lag = one("thermal-lag", &[60.0]);
        for other in [
            one("thermal-gradient", &[5e-3, 8.0]),
            one("thermal-lag", &[20.0]),
            one("mode-crossing", &[2e-4, 2.0, 25.0, 10.0]),
        ] {
            let together = problem.forward.residuals(&lag.and(&other));
            let beside = problem.forward.residuals_beside(&problem.forward.fixed(&lag), &other);
            for (a, b) in together.delta.iter().zip(&beside.delta) {
                assert!((a - b).amax() < 1e-6);
            }
            for (a, b) in together.sum.unwrap().iter().zip(&beside.sum.unwrap()) {
                assert!((a - b).amax() < 1e-6);
            }
        }
    }
}
