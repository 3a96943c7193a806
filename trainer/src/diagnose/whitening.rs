//! What noise looks like, and how it is taken out of the way.
//!
//! A residual is not white: flicker and random walk make neighbours alike, a table error shifts a position, a
//! soak that is not quite like the last one shifts a node, a mounting shifts a run in proportion to the
//! acceleration across the input axis, a start shifts a run. An effect is judged by what it explains beyond all
//! that. The noise is a sum of states that a Kalman filter tracks; its innovations are white, and every column
//! that goes through the same filter can be compared by plain least squares.

use super::layout::{Cell, Layout, Stretch};
use nalgebra::{DMatrix, SMatrix, SVector};
use rayon::prelude::*;

/// Values of several columns at the cells: one matrix a run, a row a cell.
pub(super) type Columns = Vec<DMatrix<f64>>;

/// Standard deviations of the parts of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoiseModel {
    /// Of a sample.
    pub sample: f64,
    /// What a °C unseen is worth.
    pub per_c: f64,
    /// Of the parts, in the order of the constants below.
    pub parts: [f64; PARTS],
}

/// How many parts there are.
pub(super) const PARTS: usize = 8;
/// From run to run.
pub(super) const RUN: usize = 0;
/// From run to run, per g across the input axis.
pub(super) const MOUNTING: usize = 1;
/// From position to position, per g across the input axis.
pub(super) const POSITION: usize = 2;
/// From soaked node to soaked node.
pub(super) const NODE: usize = 3;
/// Wander within minutes.
pub(super) const FLICKER: usize = 4;
/// Wander within hours.
pub(super) const WANDER: usize = 5;
/// Random walk, per √s.
pub(super) const WALK: usize = 6;
/// What effects with a memory brought along from before the run.
pub(super) const BEGINNING: usize = 7;

/// Correlation times of the two octaves of flicker and of the wander, s.
const TAUS_S: [f64; 3] = [60.0, 600.0, 5000.0];

// States: run, mounting, position, node, two of flicker, wander, walk, beginning.
const STATES: usize = 9;
type State = SVector<f64, STATES>;
type Covariance = SMatrix<f64, STATES, STATES>;

/// Columns whose noise is white with variance one.
pub(super) struct Whitened {
    /// The columns.
    pub columns: Columns,
    /// Logarithm of the determinant of the noise's covariance.
    pub log_det: f64,
}

/// The filter's work at one cell, the same for every column.
struct Step {
    seen: [f64; STATES],
    kept: [f64; STATES],
    gain: [f64; STATES],
    scale: f64,
}

/// A small random walk adds this share of the sample noise in a second.
const SMALL_WALK: f64 = 0.01;

/// So many columns are filtered at once.
const LANES: usize = 4;

impl NoiseModel {
    /// Takes the noise's correlation out of the columns.
    pub fn whiten(&self, layout: &Layout, columns: &Columns) -> Whitened {
        let pairs: Vec<_> = layout.stretches.iter().zip(columns).collect();
        let runs = pairs.into_par_iter().map(|(stretch, values)| {
            let (steps, log_det) = self.steps(stretch);
            (filtered(&steps, values), log_det)
        });
        let (columns, log_dets): (Vec<_>, Vec<f64>) = runs.unzip();
        Whitened { columns, log_det: log_dets.iter().sum() }
    }

    /// The same with no part larger than the sample noise.
    pub fn small(&self) -> Self {
        let mut small = *self;
        small.parts.iter_mut().for_each(|part| *part = part.min(self.sample));
        small.parts[WALK] = small.parts[WALK].min(self.sample * SMALL_WALK);
        small
    }

    fn steps(&self, stretch: &Stretch) -> (Vec<Step>, f64) {
        let mut covariance = self.start();
        let (mut log_det, mut last_s) = (0.0, 0.0);
        let mut steps = Vec::with_capacity(stretch.cells.len());
        for (index, cell) in stretch.cells.iter().enumerate() {
            let kept = self.predict(&mut covariance, cell, (cell.time_s - last_s).max(0.0), index == 0);
            last_s = cell.time_s;
            let seen = sight(cell);
            let shared = covariance * seen;
            let own = self.sample.powi(2) / cell.samples + (self.per_c * cell.unseen_c).powi(2);
            let variance = seen.dot(&shared) + own;
            let gain = shared / variance;
            covariance -= gain * shared.transpose();
            log_det += variance.ln();
            steps.push(Step { seen: seen.into(), kept: kept.into(), gain: gain.into(), scale: variance.sqrt().recip() });
        }
        (steps, log_det)
    }

    fn start(&self) -> Covariance {
        let [run, mounting, position, node, flicker, wander, _, beginning] = self.parts.map(|sigma| sigma * sigma);
        let start = [run, mounting, position, node, flicker, flicker, wander, 0.0, beginning];
        Covariance::from_diagonal(&State::from(start))
    }

    /// Moves the states' covariance on to `cell`; returns which share of each state is kept.
    fn predict(&self, covariance: &mut Covariance, cell: &Cell, dt_s: f64, first: bool) -> State {
        let mut kept = State::repeat(1.0);
        if first {
            return kept;
        }
        let [_, _, position, node, flicker, wander, walk, _] = self.parts.map(|sigma| sigma * sigma);
        let fresh = |is_new: bool| if is_new { 0.0 } else { 1.0 };
        (kept[2], kept[3]) = (fresh(cell.new_position), fresh(cell.new_node));
        for (slot, tau_s) in TAUS_S.into_iter().enumerate() {
            kept[4 + slot] = (-dt_s / tau_s).exp();
        }
        for i in 0..STATES {
            for j in 0..STATES {
                covariance[(i, j)] *= kept[i] * kept[j];
            }
        }
        let stationary = [position, node, flicker, flicker, wander];
        for (state, variance) in (2..).zip(stationary) {
            covariance[(state, state)] += variance * (1.0 - kept[state].powi(2));
        }
        covariance[(7, 7)] += walk * dt_s;
        kept
    }
}

/// How each state shows in a cell.
fn sight(cell: &Cell) -> State {
    State::from([1.0, cell.cross_g, cell.cross_g, 1.0, 1.0, 1.0, 1.0, 1.0, cell.beginning])
}

fn filtered(steps: &[Step], values: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, width) = values.shape();
    let mut white = DMatrix::zeros(rows, width);
    let source = values.as_slice();
    for (chunk, target) in white.as_mut_slice().chunks_mut((rows * LANES).max(1)).enumerate() {
        let lanes = target.len() / rows.max(1);
        let start = chunk * rows * LANES;
        let mut states = [[0.0; LANES]; STATES];
        for (row, step) in steps.iter().enumerate() {
            let mut values = [0.0; LANES];
            for lane in 0..lanes {
                values[lane] = source[start + lane * rows + row];
            }
            innovate(step, &mut states, &mut values);
            for lane in 0..lanes {
                target[lane * rows + row] = values[lane] * step.scale;
            }
        }
    }
    white
}

/// Turns values into what the past did not foretell, and learns from it.
fn innovate(step: &Step, states: &mut [[f64; LANES]; STATES], values: &mut [f64; LANES]) {
    for (state, (kept, seen)) in states.iter_mut().zip(step.kept.iter().zip(&step.seen)) {
        for (state, value) in state.iter_mut().zip(values.iter_mut()) {
            *state *= kept;
            *value -= seen * *state;
        }
    }
    for (state, gain) in states.iter_mut().zip(&step.gain) {
        for (state, value) in state.iter_mut().zip(values.iter()) {
            *state += gain * value;
        }
    }
}
