//! How what effects leave changes with their parameters.

use super::effect_set::EffectSet;
use super::residuals::CellResiduals;
use crate::diagnose::cells::{Columns, difference, joined};

/// Derivatives by the k free parameters, per unit of the optimiser's parameter: of each run cells × k.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::cells::width;
    use crate::diagnose::example::{Recipe, dense, effect, near, problem};

    #[test]
    fn derivatives_are_what_a_step_twice_as_long_finds_too() {
        let campaign = Recipe { sum: true, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let set = [
            ("thermal-lag", vec![60.0]),
            ("warm-up", vec![3e-4, 700.0]),
            ("mode-crossing", vec![2e-4, 2.0, 25.0, 10.0]),
        ]
        .iter()
        .fold(EffectSet::NONE, |set, (name, values)| set.with(&effect(name, &campaign), values));
        let (forward, base) = (&problem.forward, problem.forward.residuals(&set));
        let found = forward.jacobian(forward.no_effects(), &set, &base);
        let parameters = set.coefficients.to_parameters(&set.effects);
        assert_eq!((parameters.len(), width(&found.delta), width(found.sum.as_ref().unwrap())), (7, 7, 7));
        for index in 0..parameters.len() {
            let step = 2.0 * STEP * parameters[index].abs().clamp(1e-4, 1.0);
            let at = |step: f64| {
                let mut stepped = parameters.clone();
                stepped[index] += step;
                forward.residuals(&set.at(&stepped))
            };
            let (up, down) = (at(step), at(-step));
            let column = |columns: &Columns| dense(columns).columns(index, 1).into_owned();
            let worked = dense(&slope(&up.delta, &down.delta, 2.0 * step));
            assert!(near(&column(&found.delta), &worked, 1e-3), "{index}");
            let worked = dense(&slope(&up.sum.unwrap(), &down.sum.unwrap(), 2.0 * step));
            let found = column(found.sum.as_ref().unwrap());
            // Only the lag tells of the sum; the rest is rounding, over a small step.
            let is_lag = index == 0;
            assert!(
                if is_lag { near(&found, &worked, 1e-3) } else { found.amax() < 1.0 },
                "sum {index}: {}",
                found.amax()
            );
            assert!(!is_lag || found.amax() > 1e3, "{}", found.amax());
        }
    }
}
