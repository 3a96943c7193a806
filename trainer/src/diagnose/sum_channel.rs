//! The sum of the frequencies: a thermometer without lag, and the second half of an effect's fingerprint.
//!
//! What warms the resonators moves the sum by its slope over temperature, −4.8 Hz/K for silicon; a clock
//! moves both by the same fraction; heat flowing from one resonator to the other cancels in the sum. So a
//! hypothesis about the difference predicts the sum, or leaves it free, and is held to it.

use super::instrument::{Contributions, polynomials};
use super::layout::{Cell, Layout};
use super::whitening::Columns;
use crate::campaign::Row;
use crate::fit::effects::Contribution;
use crate::noise::{normal_sigma, rms};
use firmware_core::effect::About;
use nalgebra::{DMatrix, DVector, SVD};

/// What an effect does to the sum of the frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Response {
    /// What its contributions say: warmer resonators, another clock.
    Told,
    /// In proportion to its bias, by at most so many times what the difference moves.
    Free(f64),
}

/// Of the forks' frequencies, heat between them moves the sum by less than the difference.
const GRADIENT: f64 = 2.0;
/// Drive, charge and electronics move the sum ten times as much as the difference.
const ELECTRONICS: f64 = 40.0;
/// Stress of the package moves the sum up to a hundred times as much as the difference.
const STRESS: f64 = 400.0;

/// What this effect does to the sum.
pub(super) fn response(about: &About) -> Response {
    match about.name {
        "thermal-lag" | "self-heating" | "reference-clock" => Response::Told,
        "thermal-gradient" | "lock-in" | "g-hysteresis" => Response::Free(GRADIENT),
        "warm-up" | "supply-voltage" => Response::Free(ELECTRONICS),
        _ => Response::Free(STRESS),
    }
}

/// Whether the contributions of this effect say what happens to the sum.
pub(super) fn is_told(about: &About) -> bool {
    response(about) == Response::Told
}

/// The measured sum in cells.
#[derive(Clone)]
pub(super) struct SumChannel {
    /// Measured minus a smooth map of the sum, mHz, run by run: one row.
    pub residual: Columns,
    /// How that map could change, mHz.
    pub freedom: Columns,
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
/// Freedom of the map in units of the residual's scatter: as good as any.
const GENEROUS: f64 = 1e3;

impl SumChannel {
    /// The sum channel, if every row has it.
    pub fn new(layout: &Layout) -> Option<Self> {
        let measured: Vec<Vec<f64>> = layout.stretches.iter().map(|stretch| sums(stretch)).collect::<Option<_>>()?;
        let columns = |cell: &Cell| polynomials(cell.x, cell.t);
        let rows: Vec<Vec<f64>> = layout.cells().map(columns).collect();
        let width = rows.first()?.len();
        let design = DMatrix::from_row_iterator(rows.len(), width, rows.iter().flatten().copied());
        let target = DVector::from_iterator(rows.len(), measured.iter().flatten().copied());
        let fit = SVD::new(design.clone(), true, true).solve(&target, 1e-9 * target.len() as f64).ok()?;
        let misfit = &target - &design * &fit;
        let scatter = (misfit.norm_squared() / misfit.len() as f64).sqrt().max(1e-6);
        let smooth = |x: f64, t: f64| DVector::from_vec(polynomials(x, t)).dot(&fit);
        let mut misfits = misfit.iter().copied();
        let mut channel =
            Self { residual: Vec::new(), freedom: Vec::new(), cells: Vec::new(), sample: 0.0, per_c: 0.0 };
        for (stretch, measured) in layout.stretches.iter().zip(&measured) {
            let half_c = layout.scale.temperature_half_span_c;
            let slope =
                |cell: &Cell| (smooth(cell.x, cell.t + STEP) - smooth(cell.x, cell.t - STEP)) / (2.0 * STEP * half_c);
            channel.cells.push(stretch.cells.iter().map(slope).zip(measured.iter().copied()).collect());
            channel.residual.push(DMatrix::from_iterator(measured.len(), 1, misfits.by_ref().take(measured.len())));
            let freedom =
                stretch.cells.iter().flat_map(|cell| columns(cell).into_iter().map(|v| v * scatter * GENEROUS));
            channel.freedom.push(DMatrix::from_row_iterator(measured.len(), width, freedom));
        }
        channel.sample = channel.sample_scatter(layout)?;
        let slopes: Vec<f64> = channel.cells.iter().flatten().map(|(slope, _)| *slope).collect();
        channel.per_c = rms(&slopes);
        Some(channel)
    }

    /// The residual with these contributions taken out, mHz.
    pub fn residual_under(&self, layout: &Layout, contributions: &[&Contributions]) -> Columns {
        let mut residual = self.residual.clone();
        for (run, (row, cells)) in residual.iter_mut().zip(&self.cells).enumerate() {
            let of = |index| {
                contributions
                    .iter()
                    .fold(Contribution::default(), |all, contributions| all.plus(&contributions[run][index]))
            };
            let contributions: Vec<Contribution> = (0..cells.len()).map(of).collect();
            let shares = clock_shares(layout, &layout.stretches[run].cells, &contributions);
            for (index, ((slope, sum), (contribution, share))) in
                cells.iter().zip(contributions.iter().zip(shares)).enumerate()
            {
                row[(index, 0)] -= slope * contribution.temperature_c + share * sum;
            }
        }
        residual
    }

    /// From differences of neighbouring samples at one position, less what the temperature does between them.
    fn sample_scatter(&self, layout: &Layout) -> Option<f64> {
        let mut steps = Vec::new();
        for (stretch, cells) in layout.stretches.iter().zip(&self.cells) {
            for (cell, (slope, _)) in stretch.cells.iter().zip(cells) {
                for pair in stretch.run.rows[cell.rows.clone()].windows(2) {
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
fn clock_shares(layout: &Layout, cells: &[Cell], contributions: &[Contribution]) -> Vec<f64> {
    let delta_f_hz =
        |cell: &Cell| layout.scale.delta_f_zero_uhz as f64 * 1e-6 + cell.x * layout.scale.delta_f_half_span_hz;
    let least_hz = LEAST_DELTA_F * layout.scale.delta_f_half_span_hz;
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

/// Below this, as a share of its half span, the difference is too small for a ratio.
const LEAST_DELTA_F: f64 = 2e-3;

fn sums(stretch: &super::layout::Stretch) -> Option<Vec<f64>> {
    let of = |cell: &Cell| {
        let rows = &stretch.run.rows[cell.rows.clone()];
        let sum: Option<f64> = rows.iter().map(|row| row.sample.sum_f_uhz.map(|uhz| uhz as f64)).sum();
        sum.map(|sum| sum * 1e-6 * MHZ / cell.samples)
    };
    stretch.cells.iter().map(of).collect()
}
