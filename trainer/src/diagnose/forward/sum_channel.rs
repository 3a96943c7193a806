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
    /// Measured minus a smooth map of the sum, mHz: of each run cells × 1.
    pub residual: Columns,
    /// How that map could change, mHz: of each run cells × polynomials.
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

    /// The residual with these contributions taken out, mHz: of each run cells × 1.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, SUM_HZ_PER_C, disturbed, effect, problem};
    use crate::diagnose::forward::EffectSet;

    #[test]
    fn the_slope_of_the_sum_is_found_and_what_is_left_is_its_noise() {
        let campaign = Recipe { sum: true, ..Recipe::default() }.campaign();
        let unmeasured = Recipe::default().campaign();
        assert!(SumChannel::new(problem(&unmeasured).cells()).is_none());
        let problem = problem(&campaign);
        let channel = problem.forward.sum.as_ref().unwrap();
        assert!((channel.per_c + SUM_HZ_PER_C * 1e3).abs() < 5.0, "{}", channel.per_c);
        assert!((4.0..6.0).contains(&channel.sample), "{}", channel.sample);
        let rms_mhz = problem.cells().rms(&channel.residual);
        assert!((4.0..6.0).contains(&rms_mhz), "{rms_mhz}");
    }

    #[test]
    fn resonators_that_lag_move_the_sum_by_its_slope() {
        let still = Recipe { sum: true, ..Recipe::default() }.campaign();
        let lag = EffectSet::NONE.with(&effect("thermal-lag", &still), &[60.0]);
        let campaign = disturbed(still, &lag);
        let problem = problem(&campaign);
        let rms_mhz = |set: &EffectSet| problem.cells().rms(&problem.forward.residuals(set).sum.unwrap());
        let ([without, with], worse) =
            ([&EffectSet::NONE, &lag].map(rms_mhz), rms_mhz(&EffectSet::NONE.with(&lag.effects[0], &[30.0])));
        // Two degrees behind at 2 °C/min are 9.6 Hz; the map absorbs some of it.
        assert!(without > 1000.0 && worse > 300.0, "{without} {worse}");
        // The map was fitted with the lag in the way, which costs a little of its slope.
        assert!(with < 0.3 * without, "{with}");
    }

    #[test]
    fn a_clock_is_off_by_one_share_wherever_the_difference_says_nothing_too() {
        let scale = InputScale {
            delta_f_zero_uhz: 76_000_000,
            delta_f_half_span_hz: 512.0,
            temperature_zero_uc: 0,
            temperature_half_span_c: 1.0,
        };
        // At 76 + 512·x Hz; at the third the difference is nothing.
        let x = [0.5, -0.5, -76.0 / 512.0, 0.25];
        let cells: Vec<Cell> =
            x.iter().enumerate().map(|(k, x)| Cell { x: *x, ..Cell::plain(k, k as f64, 1.0) }).collect();
        let off = [1e-6, 2e-6, 77.0, 3e-6];
        let contribution = |(x, share): (&f64, f64)| Contribution {
            delta_f_hz: (76.0 + 512.0 * x) * share,
            ..Contribution::default()
        };
        let contributions: Vec<Contribution> = x.iter().zip(off).map(contribution).collect();
        let found = clock_shares(&scale, &cells, &contributions);
        let worked = [1e-6, 2e-6, 2e-6, 3e-6];
        assert!(found.iter().zip(worked).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
    }
}
