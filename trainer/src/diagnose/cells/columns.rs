//! Values of several columns at the cells: one matrix a run, a row a cell.

use crate::diagnose::thresholds::GENEROUS;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// One matrix a run; each has a row for every cell of the run, and a column for everything that has a value there.
pub type Columns = Vec<DMatrix<f64>>;

/// Products of so many runs are added up by one thread.
const RUNS_TOGETHER: usize = 8;

/// Σ AᵀB over the runs: of cells × m and cells × n, m × n in the product of their units.
pub fn product(a: &Columns, b: &Columns) -> DMatrix<f64> {
    let (rows, columns) = (width(a), width(b));
    let pairs: Vec<_> = a.iter().zip(b).collect();
    // Blocks of columns at a time; `tr_mul` takes one pair of columns after the other.
    let of = |(a, b): (&DMatrix<f64>, &DMatrix<f64>)| if columns > 1 { a.transpose() * b } else { a.tr_mul(b) };
    // Not all at once: of thousands of runs the products need more room than what is multiplied.
    let sum = |some: &[_]| some.iter().fold(DMatrix::zeros(rows, columns), |sum, pair| sum + of(*pair));
    let sums: Vec<DMatrix<f64>> = pairs.par_chunks(RUNS_TOGETHER).map(sum).collect();
    sums.into_iter().reduce(|sum, next| sum + next).unwrap_or_else(|| DMatrix::zeros(rows, columns))
}

/// How many columns there are: k of cells × k.
pub fn width(columns: &Columns) -> usize {
    columns.first().map_or(0, DMatrix::ncols)
}

/// One less the other, both cells × k in one unit.
pub fn difference(a: &Columns, b: &Columns) -> Columns {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Columns of both, the first ones first: of cells × m and cells × n, cells × (m + n).
pub fn stacked(first: &Columns, second: &Columns) -> Columns {
    joined([first, second])
}

/// All columns side by side: of cells × k each, cells × Σk.
pub fn joined<'a>(columns: impl IntoIterator<Item = &'a Columns>) -> Columns {
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

/// Columns, cells × k, each so large that what it absorbs costs nothing: in the unit of `unit`, the noise of a sample.
pub fn generous(columns: &Columns, unit: f64) -> Columns {
    let largest = |column: usize| columns.iter().map(|run| run.column(column).amax()).fold(0.0, f64::max);
    let scale = |column| if largest(column) > 0.0 { GENEROUS * unit / largest(column) } else { 0.0 };
    let scales: Vec<f64> = (0..width(columns)).map(scale).collect();
    let scaled = |run: &DMatrix<f64>| DMatrix::from_fn(run.nrows(), run.ncols(), |i, j| run[(i, j)] * scales[j]);
    columns.iter().map(scaled).collect()
}
