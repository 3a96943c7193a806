//! What may adapt around the effects in question: the static map, the sum's map, and parameters of other effects.

use super::Problem;
use super::noise_models::NoiseModels;
use crate::diagnose::cells::{Columns, generous, joined, stacked};
use crate::diagnose::forward::{CellResiduals, EffectSet, FixedEffects, Jacobian};
use crate::diagnose::regression::Gls;
use crate::diagnose::thresholds::FREE_IN_SUM;
use nalgebra::DMatrix;

/// Columns whose amplitudes are nuisances: a row a cell, a column a direction; of about one where they are expected.
#[derive(Clone)]
pub struct Nuisance {
    /// What retraining can absorb of the residual, µg.
    pub delta: Columns,
    /// What a change of the sum's map, and effects that leave the sum free, can absorb of it, mHz.
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

/// What may adapt, the effects' own parameters too, as long as no noise is known.
pub fn free(problem: &Problem, set: &EffectSet) -> Nuisance {
    let fixed = fixed(problem, set);
    if set.effects.is_empty() {
        return fixed;
    }
    widened(problem, &fixed, problem.forward.no_effects(), set, &problem.forward.residuals(set))
}

/// What may adapt, the effects' own parameters too as far as the sum of the frequencies leaves them open.
pub fn constrained(problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> Nuisance {
    let fixed = fixed(problem, set);
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
