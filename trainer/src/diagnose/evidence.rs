//! How much of a residual a column explains that retraining could not.
//!
//! A score test: residual and candidate go through the noise's whitening filter, what the instrument's
//! freedom (its tangents, with training's priors) could absorb is projected off both, and what is left of
//! the candidate is compared with what is left of the residual. Nothing is retrained.
//!
//! ```text
//!   Z = W·freedom     G = ZᵀZ + I     e = W·residual     c = W·candidate
//!   s = cᵀe − cᵀZ G⁻¹ Zᵀe          M = cᵀc − cᵀZ G⁻¹ Zᵀc
//!   amplitude a = −M⁻¹s            gain = sᵀM⁻¹s  in −2 log likelihood
//! ```

use super::layout::Layout;
use super::whitening::{Columns, NoiseModel, Whitened};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};
use rayon::prelude::*;
use std::ops::Range;

/// A residual and the instrument's freedom, under one noise.
pub(super) struct Bench<'a> {
    layout: &'a Layout<'a>,
    /// The noise.
    pub noise: NoiseModel,
    freedom: Columns,
    residual: Columns,
    factor: Cholesky<f64, Dyn>,
    absorbed: DVector<f64>,
    /// Minus twice the logarithm of the restricted likelihood.
    pub deviance: f64,
}

/// What is left of candidate columns and of their products with the residual.
#[derive(Clone, Debug)]
pub(super) struct Score {
    /// M.
    pub normal: DMatrix<f64>,
    /// s.
    pub right: DVector<f64>,
}

/// Information below this share of a column's own is rounding.
const ROUNDING: f64 = 1e-10;

impl<'a> Bench<'a> {
    /// `residual` and `freedom` under `noise`; `None` if the numbers are not finite.
    pub fn new(layout: &'a Layout, noise: NoiseModel, residual: &Columns, freedom: &Columns) -> Option<Self> {
        let Whitened { columns: freedom, .. } = noise.whiten(layout, freedom);
        let Whitened { columns: residual, log_det } = noise.whiten(layout, residual);
        let mut normal = product(&freedom, &freedom);
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
        let right: DVector<f64> = product(&freedom, &residual).column(0).into();
        let squares = product(&residual, &residual)[(0, 0)];
        let factor = Cholesky::new(normal)?;
        let absorbed = factor.solve(&right);
        let deviance = log_det + log_determinant(&factor) + squares - right.dot(&absorbed);
        deviance.is_finite().then_some(Self { layout, noise, freedom, residual, factor, absorbed, deviance })
    }

    /// The score of columns.
    pub fn score(&self, columns: &Columns) -> Score {
        let columns = &self.noise.whiten(self.layout, columns).columns;
        let cross = product(&self.freedom, columns);
        let normal = product(columns, columns) - cross.tr_mul(&self.factor.solve(&cross));
        let right = product(columns, &self.residual).column(0) - cross.tr_mul(&self.absorbed);
        Score { normal, right }
    }

    /// The scores of many candidates: `widths` says how many columns each has.
    pub fn scores(&self, columns: &Columns, widths: &[usize]) -> Vec<Score> {
        let Whitened { columns, .. } = self.noise.whiten(self.layout, columns);
        let cross = product(&self.freedom, &columns);
        let solved = self.factor.solve(&cross);
        let right = product(&columns, &self.residual).column(0) - cross.tr_mul(&self.absorbed);
        let of = |places: Range<usize>| {
            let (start, width) = (places.start, places.len());
            let own: Columns = columns.iter().map(|run| run.columns(start, width).into_owned()).collect();
            let kept = product(&own, &own) - cross.columns(start, width).tr_mul(&solved.columns(start, width));
            Score { normal: kept, right: right.rows(start, width).into_owned() }
        };
        places(widths).collect::<Vec<_>>().into_par_iter().map(of).collect()
    }

    /// Of each candidate's columns: RMS size, and the greatest share of an amplitude that the instrument leaves.
    pub fn shares_left(&self, columns: &Columns, widths: &[usize]) -> Vec<(f64, f64)> {
        let cells: f64 = columns.iter().map(|run| run.nrows() as f64).sum();
        let white = self.noise.whiten(self.layout, columns).columns;
        let cross = product(&self.freedom, &white);
        let solved = self.factor.solve(&cross);
        let one = |column: usize| {
            let square = |all: &Columns| all.iter().map(|run| run.column(column).norm_squared()).sum::<f64>();
            let (size, own) = ((square(columns) / cells).sqrt(), square(&white));
            let left = own - cross.column(column).dot(&solved.column(column));
            (size, if own > 0.0 { (left / own).max(0.0).sqrt() } else { 0.0 })
        };
        let best = |a: (f64, f64), b: (f64, f64)| (a.0.max(b.0), a.1.max(b.1));
        places(widths).map(|places| places.map(one).fold((0.0, 0.0), best)).collect()
    }

    /// Columns less what the instrument's `freedom`, the one of this bench, makes of them, cell by cell.
    pub fn beyond(&self, columns: &Columns, freedom: &Columns) -> Columns {
        let white = self.noise.whiten(self.layout, columns).columns;
        let absorbed = self.factor.solve(&product(&self.freedom, &white));
        columns.iter().zip(freedom).map(|(columns, freedom)| columns - freedom * &absorbed).collect()
    }

    /// The residual less what the instrument's freedom makes of it, cell by cell.
    pub fn adapted(&self, residual: &Columns, freedom: &Columns) -> Columns {
        let own = |(residual, freedom): (&DMatrix<f64>, &DMatrix<f64>)| {
            let mut left = residual.clone();
            left.column_mut(0).gemv(-1.0, freedom, &self.absorbed, 1.0);
            left
        };
        residual.iter().zip(freedom).map(own).collect()
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

    /// Covariance of the amplitudes.
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

/// Where the columns of each candidate stand.
fn places(widths: &[usize]) -> impl Iterator<Item = Range<usize>> {
    widths.iter().scan(0, |next, width| {
        let start = *next;
        *next += width;
        Some(start..*next)
    })
}

/// Σ AᵀB over the runs.
pub(super) fn product(a: &Columns, b: &Columns) -> DMatrix<f64> {
    let (rows, columns) = (width(a), width(b));
    let pairs: Vec<_> = a.iter().zip(b).collect();
    // Blocks of columns at a time; `tr_mul` takes one pair of columns after the other.
    let of = |(a, b): (&DMatrix<f64>, &DMatrix<f64>)| if columns > 1 { a.transpose() * b } else { a.tr_mul(b) };
    let products: Vec<DMatrix<f64>> = pairs.into_par_iter().map(of).collect();
    products.into_iter().fold(DMatrix::zeros(rows, columns), |sum, product| sum + product)
}

fn log_determinant(factor: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>()
}

/// Directions of the freedom about which the data say less than this, in units of what is expected beforehand.
const LEAST_INFORMATION: f64 = 1e-3;

/// The same freedom in fewer columns: directions that the data say nothing about are left out.
pub(super) fn compressed(layout: &Layout, noise: &NoiseModel, freedom: &Columns) -> Columns {
    let white = noise.whiten(layout, freedom).columns;
    let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(product(&white, &white));
    let kept: Vec<usize> = (0..eigenvalues.len()).filter(|&i| eigenvalues[i] > LEAST_INFORMATION).collect();
    let directions = eigenvectors.select_columns(&kept);
    freedom.iter().map(|run| run * &directions).collect()
}

/// How many columns there are.
pub(super) fn width(columns: &Columns) -> usize {
    columns.first().map_or(0, DMatrix::ncols)
}

/// One less the other.
pub(super) fn difference(a: &Columns, b: &Columns) -> Columns {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Columns of both, the first ones first.
pub(super) fn stacked(first: &Columns, second: &Columns) -> Columns {
    joined([first, second])
}

/// All columns side by side.
pub(super) fn joined<'a>(columns: impl IntoIterator<Item = &'a Columns>) -> Columns {
    let columns: Vec<&Columns> = columns.into_iter().collect();
    let runs = columns.first().map_or(0, |columns| columns.len());
    let total = columns.iter().map(|columns| width(columns)).sum();
    let join = |run: usize| {
        let mut all = DMatrix::zeros(columns.first().map_or(0, |columns| columns[run].nrows()), total);
        let mut next = 0;
        for columns in &columns {
            let own = &columns[run];
            all.columns_mut(next, own.ncols()).copy_from(own);
            next += own.ncols();
        }
        all
    };
    (0..runs).map(join).collect()
}
