//! What effects leave of the residual and of the sum of the frequencies.

use super::contributions::{Contributions, contributions};
use super::effect_set::EffectSet;
use super::static_map::StaticMap;
use super::sum_channel::SumChannel;
use crate::diagnose::cells::{Cells, Columns};

/// What effects leave.
#[derive(Clone)]
pub struct CellResiduals {
    /// Reading minus reference, µg: one column.
    pub delta: Columns,
    /// Sum of the frequencies minus its map, mHz: one column.
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
