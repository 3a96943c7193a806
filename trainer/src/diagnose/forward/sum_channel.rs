//! The sum of the frequencies: a thermometer without lag, and the second half of an effect's fingerprint.
//!
//! What warms the resonators moves the sum by its slope over temperature, −4.8 Hz/K for silicon; a clock
//! moves both by the same fraction; heat flowing from one resonator to the other cancels in the sum. So a
//! hypothesis about the difference predicts the sum, or leaves it free, and is held to it.

use super::basis::polynomials;
use super::contributions::Contributions;
use crate::campaign::Row;
use crate::diagnose::cells::{Cell, Cells, Columns, RunCells};
use crate::diagnose::thresholds::{GENEROUS, LEAST_DELTA_F};
use crate::fit::dataset::InputScale;
use crate::fit::effects::Contribution;
use crate::noise::{normal_sigma, rms};
use nalgebra::{DMatrix, DVector, SVD};

/// The measured sum in cells.
#[derive(Clone)]
pub struct SumChannel {
    /// Measured minus a smooth map of the sum, mHz, run by run: one row.
    pub residual: Columns,
    /// How that map could change, mHz.
    pub nuisance: Columns,
    /// Sum's slope over temperature in each cell, mHz/°C, and the sum itself, mHz.
    cells: Vec<Vec<(f64, f64)>>,
    /// Scatter from sample to sample, mHz.
    pub sample: f64,
    /// Mean slope over temperature, mHz/°C.
    pub per_c: f64,
}

/// Hz to mHz.
const MHZ: f64 = 1e3;
/// Step in scaled temperature for the slope.
const STEP: f64 = 1e-3;

impl SumChannel {
    /// The sum channel, if every row has it.
    pub fn new(cells: &Cells) -> Option<Self> {
        let measured: Vec<Vec<f64>> = cells.runs.iter().map(|run| sums(run)).collect::<Option<_>>()?;
        let columns = |cell: &Cell| polynomials(cell.x, cell.t);
        let rows: Vec<Vec<f64>> = cells.iter().map(columns).collect();
        let width = rows.first()?.len();
        let design = DMatrix::from_row_iterator(rows.len(), width, rows.iter().flatten().copied());
        let target = DVector::from_iterator(rows.len(), measured.iter().flatten().copied());
        let fit = SVD::new(design.clone(), true, true).solve(&target, 1e-9 * target.len() as f64).ok()?;
        let misfit = &target - &design * &fit;
        let scatter = (misfit.norm_squared() / misfit.len() as f64).sqrt().max(1e-6);
        let smooth = |x: f64, t: f64| DVector::from_vec(polynomials(x, t)).dot(&fit);
        let mut misfits = misfit.iter().copied();
        let mut channel =
            Self { residual: Vec::new(), nuisance: Vec::new(), cells: Vec::new(), sample: 0.0, per_c: 0.0 };
        for (run, measured) in cells.runs.iter().zip(&measured) {
            let half_c = cells.scale.temperature_half_span_c;
            let slope =
                |cell: &Cell| (smooth(cell.x, cell.t + STEP) - smooth(cell.x, cell.t - STEP)) / (2.0 * STEP * half_c);
            channel.cells.push(run.cells.iter().map(slope).zip(measured.iter().copied()).collect());
            channel.residual.push(DMatrix::from_iterator(measured.len(), 1, misfits.by_ref().take(measured.len())));
            let nuisance = run.cells.iter().flat_map(|cell| columns(cell).into_iter().map(|v| v * scatter * GENEROUS));
            channel.nuisance.push(DMatrix::from_row_iterator(measured.len(), width, nuisance));
        }
        channel.sample = channel.sample_scatter(cells)?;
        let slopes: Vec<f64> = channel.cells.iter().flatten().map(|(slope, _)| *slope).collect();
        channel.per_c = rms(&slopes);
        Some(channel)
    }

    /// The residual with these contributions taken out, mHz.
    pub fn residual_under(&self, cells: &Cells, contributions: &[&Contributions]) -> Columns {
        let mut residual = self.residual.clone();
        for (index, (column, measured)) in residual.iter_mut().zip(&self.cells).enumerate() {
            let of = |row| contributions.iter().fold(Contribution::default(), |all, own| all.plus(&own[index][row]));
            let own: Vec<Contribution> = (0..measured.len()).map(of).collect();
            let shares = clock_shares(&cells.scale, &cells.runs[index].cells, &own);
            for (row, ((slope, sum), (own, share))) in measured.iter().zip(own.iter().zip(shares)).enumerate() {
                column[(row, 0)] -= slope * own.temperature_c + share * sum;
            }
        }
        residual
    }

    /// From differences of neighbouring samples at one position, less what the temperature does between them.
    fn sample_scatter(&self, cells: &Cells) -> Option<f64> {
        let mut steps = Vec::new();
        for (run, cells) in cells.runs.iter().zip(&self.cells) {
            for (cell, (slope, _)) in run.cells.iter().zip(cells) {
                for pair in run.run.rows[cell.rows.clone()].windows(2) {
                    let sum_uhz = |row: &Row| i128::from(row.sample.sum_f_uhz.unwrap_or_default());
                    let change = (sum_uhz(&pair[1]) - sum_uhz(&pair[0])) as f64 * 1e-6 * MHZ;
                    let temperature_c = |row: &Row| f64::from(row.sample.temperature_uc) * 1e-6;
                    let warmer_c = temperature_c(&pair[1]) - temperature_c(&pair[0]);
                    steps.push((change - slope * warmer_c).abs());
                }
            }
        }
        (!steps.is_empty()).then(|| (normal_sigma(steps) / 2.0_f64.sqrt()).max(1e-6))
    }
}

/// By which fraction a clock would have to be off in each cell for what it does to the difference; only clocks move the
/// difference in proportion to itself, so other effects' contributions must not come here. Where the difference is too small to
/// tell, the clock is as it was a moment ago.
fn clock_shares(scale: &InputScale, cells: &[Cell], contributions: &[Contribution]) -> Vec<f64> {
    let delta_f_hz = |cell: &Cell| scale.delta_f_zero_uhz as f64 * 1e-6 + cell.x * scale.delta_f_half_span_hz;
    let least_hz = LEAST_DELTA_F * scale.delta_f_half_span_hz;
    let tells = |cell: &&Cell| delta_f_hz(cell).abs() >= least_hz;
    let share =
        |(cell, contribution): (&Cell, &Contribution)| tells(&cell).then(|| contribution.delta_f_hz / delta_f_hz(cell));
    let told: Vec<Option<f64>> = cells.iter().zip(contributions).map(share).collect();
    let first = told.iter().flatten().next().copied().unwrap_or_default();
    let last = |last: &mut f64, told: &Option<f64>| {
        *last = told.unwrap_or(*last);
        Some(*last)
    };
    told.iter().scan(first, last).collect()
}

fn sums(run: &RunCells) -> Option<Vec<f64>> {
    let of = |cell: &Cell| {
        let rows = &run.run.rows[cell.rows.clone()];
        let sum: Option<f64> = rows.iter().map(|row| row.sample.sum_f_uhz.map(|uhz| uhz as f64)).sum();
        sum.map(|sum| sum * 1e-6 * MHZ / cell.samples)
    };
    run.cells.iter().map(of).collect()
}
