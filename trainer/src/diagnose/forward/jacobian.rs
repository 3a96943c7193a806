//! How what effects leave changes with their parameters.

use super::effect_set::EffectSet;
use super::residuals::CellResiduals;
use crate::diagnose::cells::{Columns, difference, joined};

/// Derivatives by the free parameters: one column a parameter, per unit of the optimiser's parameter.
pub struct Jacobian {
    /// Of the residual, µg.
    pub delta: Columns,
    /// Of the sum of the frequencies, mHz.
    pub sum: Option<Columns>,
}

/// Step of numeric derivatives: of logarithms and °C as it is, of amplitudes times their size.
const STEP: f64 = 1e-4;

impl Jacobian {
    /// What a step of each free parameter of `set` adds to difference and sum, from where it leaves `base`; by numeric
    /// differentiation of what effects leave, `residuals`.
    pub fn of(set: &EffectSet, base: &CellResiduals, residuals: impl Fn(&EffectSet) -> CellResiduals) -> Self {
        let parameters = set.coefficients.to_parameters(&set.effects);
        let (mut delta, mut sum) = (Vec::new(), Vec::new());
        for index in 0..parameters.len() {
            let mut stepped = parameters.clone();
            let step = STEP * parameters[index].abs().clamp(1e-4, 1.0);
            stepped[index] += step;
            let moved = residuals(&set.at(&stepped));
            delta.push(slope(&moved.delta, &base.delta, step));
            if let (Some(moved), Some(base)) = (&moved.sum, &base.sum) {
                sum.push(slope(moved, base, step));
            }
        }
        Self { delta: joined(&delta), sum: (!sum.is_empty()).then(|| joined(&sum)) }
    }
}

fn slope(moved: &Columns, base: &Columns, step: f64) -> Columns {
    difference(moved, base).into_iter().map(|run| run / step).collect()
}
