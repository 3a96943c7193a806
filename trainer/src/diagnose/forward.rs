//! What the sensor is taken to do, a static map and effects beside it, and what that leaves of the measurements.

mod contributions;
mod effect_set;
mod jacobian;
mod residuals;
mod static_map;
mod sum_channel;

mod basis;
pub(super) mod retraining;
pub(super) use effect_set::{EffectSet, amplitudes, is_placed, name_of};
pub(super) use jacobian::Jacobian;
pub(super) use residuals::{CellResiduals, FixedEffects};
pub(super) use retraining::Inputs;
pub(super) use static_map::StaticMap;
pub(super) use sum_channel::SumChannel;

use super::cells::{Cells, Columns, difference};
use crate::diagnose::thresholds::{LEAST_SAMPLE_UG, SILICON_G_PER_C};
use crate::noise::sample_sigma;
use contributions::contributions;
use residuals::residuals_beside;
use std::sync::Arc;

/// The measurements in cells, and what is taken for their cause.
#[derive(Clone)]
pub(super) struct Forward<'a> {
    /// The cells.
    pub cells: Arc<Cells<'a>>,
    /// The static map.
    pub map: StaticMap,
    /// The sum of the frequencies, if it was measured.
    pub sum: Option<SumChannel>,
    /// The map alone.
    none: FixedEffects,
}

impl<'a> Forward<'a> {
    /// Of a map and what was measured.
    pub fn new(cells: Arc<Cells<'a>>, map: StaticMap, sum: Option<SumChannel>) -> Self {
        let none = FixedEffects::new(&cells, &map, sum.as_ref(), &EffectSet::NONE);
        Self { cells, map, sum, none }
    }

    /// The map alone: no effects, to be fixed.
    pub fn no_effects(&self) -> &FixedEffects {
        &self.none
    }

    /// These effects, to be fixed.
    pub fn fixed(&self, set: &EffectSet) -> FixedEffects {
        FixedEffects::new(&self.cells, &self.map, self.sum.as_ref(), set)
    }

    /// What these effects leave.
    pub fn residuals(&self, set: &EffectSet) -> CellResiduals {
        self.residuals_beside(&self.none, set)
    }

    /// What these effects leave together with those that are fixed.
    pub fn residuals_beside(&self, fixed: &FixedEffects, set: &EffectSet) -> CellResiduals {
        residuals_beside(&self.cells, &self.map, self.sum.as_ref(), fixed, set)
    }

    /// What these effects leave in every cell of `cells`, which may be others than these, µg: of each
    /// run cells × 1.
    pub fn residual_in_ug(&self, cells: &Cells, set: &EffectSet) -> Columns {
        self.map.residual_ug(cells, &contributions(cells, set))
    }

    /// Scatter of what these effects leave from sample to sample, µg; `None` where there is none to be seen.
    pub fn sample_ug(&self, set: &EffectSet) -> Option<f64> {
        let residuals = self.residual_in_ug(&self.cells.by_sample(), set);
        let all: Vec<Vec<f64>> = residuals.iter().map(|run| run.iter().copied().collect()).collect();
        let runs = self.cells.runs.iter().map(|run| run.run);
        sample_sigma(runs.zip(&all)).map(|sigma| sigma.max(LEAST_SAMPLE_UG))
    }

    /// Derivatives of what these effects leave beside fixed ones, by their free parameters, from where they leave `base`.
    pub fn jacobian(&self, fixed: &FixedEffects, set: &EffectSet, base: &CellResiduals) -> Jacobian {
        Jacobian::of(set, base, |moved| self.residuals_beside(fixed, moved))
    }

    /// Where these effects move the map's inputs.
    pub fn inputs(&self, set: &EffectSet) -> Inputs {
        retraining::inputs(&self.cells, &contributions(&self.cells, set))
    }

    /// How retraining could change the reading at these inputs, µg per expected change: of each run cells × functions.
    pub fn retraining(&self, inputs: &Inputs) -> Columns {
        retraining::of_retraining(&self.map, inputs)
    }

    /// The same measurements with another map.
    pub fn with_map(&self, map: StaticMap) -> Self {
        Self::new(self.cells.clone(), map, self.sum.clone())
    }

    /// What effects by themselves add to the residual once compensated, µg: of each run cells × 1.
    pub fn alone_ug(&self, set: &EffectSet) -> Columns {
        difference(&self.residuals(set).delta, &self.residuals(&EffectSet::NONE).delta)
    }

    /// At the middle of the domain, Hz/g.
    pub fn scale_factor_hz_per_g(&self) -> f64 {
        self.map.scale_factor_hz_per_g(&self.cells)
    }

    /// By how many °C temperature must change to move a fork as 1 g does: both change its frequency by half of what they
    /// change difference and sum.
    pub fn shift_c_per_g(&self) -> f64 {
        let hz_per_g = self.scale_factor_hz_per_g().abs();
        let hz_per_c = match &self.sum {
            Some(sum) => sum.per_c.abs() * 1e-3,
            None => hz_per_g * SILICON_G_PER_C,
        };
        hz_per_g / hz_per_c.max(f64::MIN_POSITIVE)
    }

    /// Size of the scale factor, mHz per µg: its sign is a matter of wiring.
    pub fn mhz_per_ug(&self) -> f64 {
        self.scale_factor_hz_per_g().abs() * 1e3 * 1e-6
    }
}
