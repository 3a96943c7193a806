//! What may adapt around the effects in question: the static map, the sum's map, and parameters of other effects.

use super::Problem;
use super::noise_models::NoiseModels;
use crate::diagnose::cells::{Columns, generous, joined, stacked};
use crate::diagnose::forward::{CellResiduals, EffectSet, FixedEffects, Jacobian};
use crate::diagnose::regression::Gls;
use crate::diagnose::thresholds::{FREE_IN_SUM, SECOND_TAU_SHARE, SECOND_TAUS};
use nalgebra::DMatrix;

/// Columns whose amplitudes are nuisances: a row a cell, a column a direction; of about one where they are expected.
#[derive(Clone)]
pub struct Nuisance {
    /// What retraining can absorb of the residual, µg: of each run cells × p.
    pub delta: Columns,
    /// What a change of the sum's map, and effects that leave the sum free, can absorb of it, mHz: of each run
    /// cells × q.
    pub sum: Option<Columns>,
}

/// What may adapt around these effects, their own parameters fixed.
pub fn fixed(problem: &Problem, set: &EffectSet) -> Nuisance {
    let scaled = |one: &EffectSet| -> Columns {
        problem.forward.alone_ug(one).into_iter().map(|run| run * FREE_IN_SUM).collect()
    };
    let sum = problem.forward.sum.as_ref().map(|channel| {
        let columns: Vec<Columns> = set.sum_free().each().map(|one| scaled(&one)).collect();
        if columns.is_empty() { channel.nuisance.clone() } else { stacked(&channel.nuisance, &joined(&columns)) }
    });
    Nuisance { delta: problem.basis.clone(), sum }
}

/// The same, and what formulas of these effects may lack.
fn inexact(problem: &Problem, set: &EffectSet) -> Nuisance {
    let Nuisance { delta, sum } = fixed(problem, set);
    let alone = |one: EffectSet| problem.forward.alone_ug(&one).into_iter().map(|run| run * SECOND_TAU_SHARE).collect();
    let columns: Vec<Columns> =
        set.each().flat_map(|one| SECOND_TAUS.map(|ratio| one.with_tau_times(ratio))).flatten().map(alone).collect();
    Nuisance { delta: if columns.is_empty() { delta } else { stacked(&delta, &joined(&columns)) }, sum }
}

/// What may adapt, the effects' own parameters too, as long as no noise is known.
pub fn free(problem: &Problem, set: &EffectSet) -> Nuisance {
    let fixed = inexact(problem, set);
    if set.effects.is_empty() {
        return fixed;
    }
    widened(problem, &fixed, problem.forward.no_effects(), set, &problem.forward.residuals(set))
}

/// What may adapt, the effects' own parameters too as far as the sum of the frequencies leaves them open.
pub fn constrained(problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> Nuisance {
    let fixed = inexact(problem, set);
    if set.effects.is_empty() {
        return fixed;
    }
    let residuals = problem.forward.residuals(set);
    let jacobian = problem.forward.jacobian(problem.forward.no_effects(), set, &residuals);
    let mut nuisance = with_jacobian(problem, &fixed, &jacobian);
    let predicted: Vec<usize> =
        set.predicts().enumerate().filter_map(|(place, predicts)| predicts.then_some(place)).collect();
    let sum = jacobian.sum.as_ref().filter(|_| !predicted.is_empty());
    if let Some(open) = left_open(problem, &residuals, &fixed, noises, sum, &predicted) {
        for (free, delta) in nuisance.delta.iter_mut().zip(&jacobian.delta) {
            let (first, columns) = (free.ncols() - delta.ncols(), delta.select_columns(&predicted) * &open);
            predicted.iter().zip(columns.column_iter()).for_each(|(place, own)| free.set_column(first + place, &own));
        }
    }
    nuisance
}

/// How the sum of the frequencies leaves parameters open that it tells of: a root of their covariance.
fn left_open(
    problem: &Problem,
    residuals: &CellResiduals,
    fixed: &Nuisance,
    noises: &NoiseModels,
    jacobian: Option<&Columns>,
    predicted: &[usize],
) -> Option<DMatrix<f64>> {
    let columns: Columns = jacobian?.iter().map(|run| run.select_columns(predicted)).collect();
    let (residual, nuisance) = (residuals.sum.as_ref()?, fixed.sum.as_ref()?);
    let gls = Gls::new(problem.cells(), &noises.initial, &noises.sum?, residual, nuisance)?;
    Some(gls.score(&columns).covariance()?.cholesky()?.unpack())
}

/// `nuisance`, and the parameters of effects that leave `residuals` beside others that are fixed.
pub fn widened(
    problem: &Problem,
    nuisance: &Nuisance,
    fixed: &FixedEffects,
    own: &EffectSet,
    residuals: &CellResiduals,
) -> Nuisance {
    with_jacobian(problem, nuisance, &problem.forward.jacobian(fixed, own, residuals))
}

fn with_jacobian(problem: &Problem, nuisance: &Nuisance, jacobian: &Jacobian) -> Nuisance {
    let both = nuisance.sum.as_ref().zip(jacobian.sum.as_ref()).zip(problem.forward.sum.as_ref());
    Nuisance {
        delta: stacked(&nuisance.delta, &generous(&jacobian.delta, problem.sample_ug)),
        sum: both.map(|((nuisance, sum), channel)| stacked(nuisance, &generous(sum, channel.sample))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::cells::width;
    use crate::diagnose::example::{Recipe, dense, effect, near, problem, white};
    use crate::diagnose::thresholds::GENEROUS;

    fn with_sum(test: impl Fn(&Problem, &EffectSet, &EffectSet)) {
        let campaign = Recipe { runs: 2, sum: true, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let lag = EffectSet::NONE.with(&effect("thermal-lag", &campaign), &[40.0]);
        let gradient = EffectSet::NONE.with(&effect("thermal-gradient", &campaign), &[5e-3, 8.0]);
        test(&problem, &lag, &gradient);
    }

    #[test]
    fn without_effects_the_maps_alone_may_adapt() {
        with_sum(|problem, _, _| {
            let noises = white(problem, &EffectSet::NONE, 5.0);
            let own = problem.forward.sum.as_ref().unwrap();
            let none = &EffectSet::NONE;
            for nuisance in [fixed(problem, none), free(problem, none), constrained(problem, none, &noises)] {
                assert_eq!(nuisance.delta, problem.basis);
                assert_eq!(nuisance.sum.as_ref(), Some(&own.nuisance));
            }
        });
    }

    #[test]
    fn fixed_effects_that_leave_the_sum_free_show_in_it_as_they_show_in_the_difference() {
        with_sum(|problem, lag, gradient| {
            let maps = width(&problem.forward.sum.as_ref().unwrap().nuisance);
            assert_eq!(width(fixed(problem, lag).sum.as_ref().unwrap()), maps);
            let nuisance = fixed(problem, &lag.and(gradient));
            assert_eq!(nuisance.delta, problem.basis);
            let sum = nuisance.sum.unwrap();
            assert_eq!(width(&sum), maps + 1);
            let last = dense(&sum).columns(maps, 1).into_owned();
            assert!(near(&last, &(dense(&problem.forward.alone_ug(gradient)) * FREE_IN_SUM), 1e-12));
        });
    }

    #[test]
    fn a_formula_of_one_time_constant_may_lack_others() {
        with_sum(|problem, lag, gradient| {
            let maps = width(&problem.basis);
            let nuisance = inexact(problem, lag);
            assert_eq!(width(&nuisance.delta), maps + SECOND_TAUS.len());
            for (place, ratio) in SECOND_TAUS.into_iter().enumerate() {
                let other = lag.with_tau_times(ratio).unwrap();
                assert!(
                    (other.coefficients.values[0][0] / (ratio * lag.coefficients.values[0][0]) - 1.0).abs() < 1e-12
                );
                let worked = dense(&problem.forward.alone_ug(&other)) * SECOND_TAU_SHARE;
                assert!(near(&dense(&nuisance.delta).columns(maps + place, 1).into_owned(), &worked, 1e-12));
            }
            // Its amplitude is the effect's own, and beyond the bounds of the formula there are none.
            assert_eq!(
                gradient.with_tau_times(2.8).unwrap().coefficients.values[0][0],
                gradient.coefficients.values[0][0]
            );
            assert!(gradient.with_tau_times(1e6).is_none() && EffectSet::NONE.with_tau_times(2.8).is_none());
            assert_eq!(inexact(problem, &EffectSet::NONE).delta, problem.basis);
        });
    }

    #[test]
    fn free_parameters_each_add_a_column_so_large_that_it_costs_nothing() {
        with_sum(|problem, lag, gradient| {
            let both = lag.and(gradient);
            let nuisance = free(problem, &both);
            let maps = width(&inexact(problem, &both).delta);
            assert_eq!(width(&nuisance.delta), maps + 3);
            let all = dense(&nuisance.delta);
            for column in maps..maps + 3 {
                let largest = all.column(column).amax();
                assert!((largest / (GENEROUS * problem.sample_ug) - 1.0).abs() < 1e-9, "{column}: {largest}");
            }
        });
    }

    #[test]
    fn what_the_sum_tells_of_a_parameter_binds_it_and_what_it_does_not_tell_stays_free() {
        with_sum(|problem, lag, gradient| {
            let both = lag.and(gradient);
            let noises = white(problem, &both, 5.0);
            let (open, bound) = (free(problem, &both), constrained(problem, &both, &noises));
            let maps = width(&inexact(problem, &both).delta);
            let largest = |nuisance: &Nuisance, column: usize| dense(&nuisance.delta).column(maps + column).amax();
            // The lag's time constant is known to about a second from the sum; the gradient's two are as they were.
            assert!(largest(&bound, 0) < 0.05 * largest(&open, 0), "{} {}", largest(&bound, 0), largest(&open, 0));
            for column in [1, 2] {
                assert!((largest(&bound, column) / largest(&open, column) - 1.0).abs() < 1e-12, "{column}");
            }
            // The column is the derivative times the parameter's standard uncertainty from the sum alone.
            let residuals = problem.forward.residuals(&both);
            let jacobian = problem.forward.jacobian(problem.forward.no_effects(), &both, &residuals);
            let fixed = fixed(problem, &both);
            let gls = Gls::new(
                problem.cells(),
                &noises.initial,
                &noises.sum.unwrap(),
                residuals.sum.as_ref().unwrap(),
                fixed.sum.as_ref().unwrap(),
            );
            let of_lag: Columns =
                jacobian.sum.as_ref().unwrap().iter().map(|run| run.columns(0, 1).into_owned()).collect();
            let sigma = gls.unwrap().score(&of_lag).normal[(0, 0)].sqrt().recip();
            let worked = dense(&jacobian.delta).columns(0, 1) * sigma;
            assert!(near(&dense(&bound.delta).columns(maps, 1).into_owned(), &worked, 1e-6));
        });
    }
}
