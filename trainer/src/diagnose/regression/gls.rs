//! How much of a residual a column explains that retraining could not.
//!
//! A score test: residual and candidate go through the noise's whitening filter, what the map's
//! nuisance (its tangents, with training's priors) could absorb is projected off both, and what is left of
//! the candidate is compared with what is left of the residual. Nothing is retrained.
//!
//! ```text
//!   Z = W·nuisance     G = ZᵀZ + I     e = W·residual     c = W·candidate
//!   s = cᵀe − cᵀZ G⁻¹ Zᵀe          M = cᵀc − cᵀZ G⁻¹ Zᵀc
//!   amplitude a = −M⁻¹s            gain = sᵀM⁻¹s  in −2 log likelihood
//! ```

use crate::diagnose::cells::{Cells, Columns, joined, product, width};
use crate::diagnose::noise::{InitialStates, NoiseModel, Whitening};
use crate::diagnose::thresholds::LEAST_INFORMATION;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// A residual and the map's nuisance, under one noise.
pub struct Gls {
    whitening: Whitening,
    nuisance: Columns,
    residual: Columns,
    factor: Cholesky<f64, Dyn>,
    absorbed: DVector<f64>,
    /// Minus twice the logarithm of the restricted likelihood.
    pub deviance: f64,
}

/// What is left of candidate columns and of their products with the residual.
#[derive(Clone, Debug)]
pub struct Score {
    /// M: k × k, per squared unit of an amplitude.
    pub normal: DMatrix<f64>,
    /// s: k, per unit of an amplitude.
    pub right: DVector<f64>,
}

/// Information below this share of a column's own is rounding.
const ROUNDING: f64 = 1e-10;

/// So many candidates are scored together: few enough for a processor's cache, enough to share the work.
const TOGETHER: usize = 16;

/// And so many such groups are made at once.
const GROUPS: usize = 4;

/// Several candidates' whitened columns, side by side.
struct Together {
    /// Where each candidate's stand.
    places: Vec<Range<usize>>,
    columns: Columns,
    /// Zᵀc.
    cross: DMatrix<f64>,
    /// G⁻¹ Zᵀc.
    solved: DMatrix<f64>,
}

impl Gls {
    /// `residual` (of each run cells × 1) and `nuisance` (cells × p) under `noise`, all in its unit, µg or mHz; `None`
    /// if the numbers are not finite.
    pub fn new(
        cells: &Cells,
        initial: &InitialStates,
        noise: &NoiseModel,
        residual: &Columns,
        nuisance: &Columns,
    ) -> Option<Self> {
        let whitening = Whitening::new(cells, initial, noise);
        let (nuisance, residual) = (whitening.of(nuisance), whitening.of(residual));
        let mut normal = product(&nuisance, &nuisance);
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
        let right: DVector<f64> = product(&nuisance, &residual).column(0).into();
        let squares = product(&residual, &residual)[(0, 0)];
        let factor = Cholesky::new(normal)?;
        let absorbed = factor.solve(&right);
        let deviance = whitening.log_det + log_determinant(&factor) + squares - right.dot(&absorbed);
        deviance.is_finite().then_some(Self { whitening, nuisance, residual, factor, absorbed, deviance })
    }

    /// Amplitudes of the nuisance, one a column of it, if what is expected of them is learnt so many times: each time they
    /// are expected where they were found the time before.
    pub fn absorbed(&self, times: usize) -> DVector<f64> {
        // With what was absorbed taken out, Zᵀ(e − Z·a) = G·a − Z·Zᵀ·a = a is the next right-hand side.
        let each = std::iter::successors(Some(self.absorbed.clone()), |last| Some(self.factor.solve(last)));
        each.take(times).fold(DVector::zeros(self.absorbed.len()), |sum, next| sum + next)
    }

    /// The score of k columns: of each run cells × k, in the residual's unit per unit of an amplitude.
    pub fn score(&self, columns: &Columns) -> Score {
        let columns = &self.whitening.of(columns);
        let cross = product(&self.nuisance, columns);
        let normal = product(columns, columns) - cross.tr_mul(&self.factor.solve(&cross));
        let right = product(columns, &self.residual).column(0) - cross.tr_mul(&self.absorbed);
        Score { normal, right }
    }

    /// The score of k columns that are nothing but in one run: cells of that run × k.
    pub fn score_in(&self, run: usize, columns: &DMatrix<f64>) -> Score {
        let columns = self.whitening.of_run(run, columns);
        let cross = self.nuisance[run].tr_mul(&columns);
        let normal = columns.tr_mul(&columns) - cross.tr_mul(&self.factor.solve(&cross));
        let right = columns.tr_mul(&self.residual[run]).column(0) - cross.tr_mul(&self.absorbed);
        Score { normal, right }
    }

    /// The scores of many candidates, whose columns (of each run cells × k, k the candidate's own) are asked for when
    /// their turn comes.
    pub fn scores<'c, T: Sync>(
        &self,
        candidates: &'c [T],
        columns: impl Fn(&'c T) -> Cow<'c, Columns> + Sync,
    ) -> Vec<Score> {
        let of = |some: &[&Columns]| {
            let Together { places, columns, cross, solved } = self.together(some);
            let right = product(&columns, &self.residual).column(0) - cross.tr_mul(&self.absorbed);
            let normal = product(&columns, &columns) - cross.tr_mul(&solved);
            let score = |place: Range<usize>| Score {
                normal: normal.view((place.start, place.start), (place.len(), place.len())).into_owned(),
                right: right.rows(place.start, place.len()).into_owned(),
            };
            places.into_iter().map(score).collect()
        };
        in_turn(candidates, columns, of)
    }

    /// Of each candidate's columns, of each run cells × k: RMS size, and the greatest share of an amplitude that the map leaves.
    pub fn shares_left<'c, T: Sync>(
        &self,
        candidates: &'c [T],
        columns: impl Fn(&'c T) -> Cow<'c, Columns> + Sync,
    ) -> Vec<(f64, f64)> {
        let cells: f64 = self.residual.iter().map(|run| run.nrows() as f64).sum();
        let square =
            |all: &Columns, column: usize| all.iter().map(|run| run.column(column).norm_squared()).sum::<f64>();
        let of = |some: &[&Columns]| {
            let Together { places, columns, cross, solved } = self.together(some);
            let share = |column: usize| {
                let own = square(&columns, column);
                let left = own - cross.column(column).dot(&solved.column(column));
                if own > 0.0 { (left / own).max(0.0).sqrt() } else { 0.0 }
            };
            let greatest = |(candidate, place): (&&Columns, Range<usize>)| {
                let sizes = (0..width(candidate)).map(|column| (square(candidate, column) / cells).sqrt());
                (sizes.fold(0.0, f64::max), place.map(share).fold(0.0, f64::max))
            };
            some.iter().zip(places).map(greatest).collect()
        };
        in_turn(candidates, columns, of)
    }

    fn together(&self, candidates: &[&Columns]) -> Together {
        let columns = self.whitening.of(&joined(candidates.iter().copied()));
        let cross = product(&self.nuisance, &columns);
        let solved = self.factor.solve(&cross);
        Together { places: places(candidates), columns, cross, solved }
    }

    /// Columns (of each run cells × k) less what the map's `nuisance` (cells × p), the one of this problem, makes of
    /// them, cell by cell: cells × k, in their unit.
    pub fn beyond(&self, columns: &Columns, nuisance: &Columns) -> Columns {
        let white = self.whitening.of(columns);
        let absorbed = self.factor.solve(&product(&self.nuisance, &white));
        columns.iter().zip(nuisance).map(|(columns, nuisance)| columns - nuisance * &absorbed).collect()
    }

    /// The residual (of each run cells × 1) less what the map's nuisance (cells × p) makes of it, cell by cell:
    /// cells × 1.
    pub fn adapted(&self, residual: &Columns, nuisance: &Columns) -> Columns {
        let own = |(residual, nuisance): (&DMatrix<f64>, &DMatrix<f64>)| {
            let mut left = residual.clone();
            left.column_mut(0).gemv(-1.0, nuisance, &self.absorbed, 1.0);
            left
        };
        residual.iter().zip(nuisance).map(own).collect()
    }
}

impl Score {
    /// Of columns whose amplitudes this and `other` measurements share.
    pub fn tied(mut self, other: &Self) -> Self {
        self.normal += &other.normal;
        self.right += &other.right;
        self
    }

    /// The amplitudes that explain most.
    pub fn amplitudes(&self) -> Option<DVector<f64>> {
        Some(-self.factor()?.solve(&self.right))
    }

    /// Twice the gain in log likelihood with the best amplitudes.
    pub fn gain(&self) -> f64 {
        self.factor().map_or(0.0, |factor| self.right.dot(&factor.solve(&self.right)))
    }

    /// Twice the gain with the columns as they are.
    pub fn gain_as_is(&self) -> f64 {
        -2.0 * self.right.sum() - self.normal.sum()
    }

    /// Covariance of the amplitudes: k × k.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        Some(self.factor()?.inverse())
    }

    fn factor(&self) -> Option<Cholesky<f64, Dyn>> {
        let mut normal = self.normal.clone();
        for i in 0..normal.nrows() {
            normal[(i, i)] = normal[(i, i)] * (1.0 + ROUNDING) + f64::MIN_POSITIVE;
        }
        Cholesky::new(normal)
    }
}

/// Something of each candidate, some at a time: there may be no room for the columns of all of them.
fn in_turn<'c, T: Sync, R: Send>(
    candidates: &'c [T],
    columns: impl Fn(&'c T) -> Cow<'c, Columns> + Sync,
    of: impl Fn(&[&Columns]) -> Vec<R> + Sync,
) -> Vec<R> {
    let turn = |some: &'c [T]| {
        let made: Vec<Cow<Columns>> = some.par_iter().map(&columns).collect();
        let made: Vec<&Columns> = made.iter().map(AsRef::as_ref).collect();
        made.par_chunks(TOGETHER).flat_map_iter(&of).collect::<Vec<R>>()
    };
    candidates.chunks(TOGETHER * GROUPS).flat_map(turn).collect()
}

/// Where the columns of each candidate stand when all are side by side.
fn places(candidates: &[&Columns]) -> Vec<Range<usize>> {
    let place = |next: &mut usize, columns: &&Columns| {
        let start = *next;
        *next += width(columns);
        Some(start..*next)
    };
    candidates.iter().scan(0, place).collect()
}

fn log_determinant(factor: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>()
}

/// Directions of a nuisance about which the data say anything: a row a column of it, a column a direction.
pub fn directions(cells: &Cells, noise: &NoiseModel, nuisance: &Columns) -> DMatrix<f64> {
    let white = Whitening::new(cells, &InitialStates::default(), noise).of(nuisance);
    let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(product(&white, &white));
    let kept: Vec<usize> = (0..eigenvalues.len()).filter(|&i| eigenvalues[i] > LEAST_INFORMATION).collect();
    eigenvectors.select_columns(&kept)
}

#[cfg(test)]
mod tests;
