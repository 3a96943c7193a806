//! What noise looks like, and how it is taken out of the way.
//!
//! A residual is not white: flicker and random walk make neighbours alike, a table error shifts a position, a
//! soak that is not quite like the last one shifts a node, a mounting shifts a run in proportion to the
//! acceleration across the input axis, a start shifts a run. An effect is judged by what it explains beyond all
//! that. The noise is a sum of states that a Kalman filter tracks; its innovations are white, and every column
//! that goes through the same filter can be compared by plain least squares.

use super::layout::{Cell, Layout, Stretch};
use nalgebra::DMatrix;
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
pub(super) const PARTS: usize = 9;
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
/// From position to position, whatever acceleration lies across the input axis: no table does that.
pub(super) const POSE: usize = 8;

/// Correlation times of the two octaves of flicker and of the wander, s.
const TAUS_S: [f64; 3] = [60.0, 600.0, 5000.0];

/// Most states: one a part, and another octave of flicker.
const STATES: usize = PARTS + 1;

/// Columns whose noise is white with variance one.
pub(super) struct Whitened {
    /// The columns.
    pub columns: Columns,
    /// Logarithm of the determinant of the noise's covariance.
    pub log_det: f64,
}

/// One state of the filter.
#[derive(Clone, Copy)]
struct State {
    kind: Kind,
    /// Its variance at the start and in equilibrium; what it gains in a second, for a walk.
    variance: f64,
}

#[derive(Clone, Copy)]
enum Kind {
    Run,
    Mounting,
    Position,
    Node,
    Fading(f64),
    Walk,
    Beginning,
    Pose,
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

impl NoiseModel {
    /// Takes the noise's correlation out of the columns.
    pub fn whiten(&self, layout: &Layout, columns: &Columns) -> Whitened {
        let pairs: Vec<_> = layout.stretches.iter().zip(columns).collect();
        let states = self.states();
        let runs = pairs.into_par_iter().map(|(stretch, values)| {
            let (steps, log_det) = self.steps(stretch, &states);
            let white = if values.ncols() == 1 { filtered::<1> } else { filtered::<4> };
            (white(&steps, states.len(), values), log_det)
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

    /// The same with no wander larger than the sample noise: what swings is taken for wander otherwise.
    pub fn calm(&self) -> Self {
        let mut calm = *self;
        let small = self.small();
        [FLICKER, WANDER, WALK].into_iter().for_each(|part| calm.parts[part] = small.parts[part]);
        calm
    }

    /// The states that make a difference.
    fn states(&self) -> Vec<State> {
        let [run, mounting, position, node, flicker, wander, walk, beginning, pose] = self.parts;
        let [fast, slow, slowest] = TAUS_S.map(Kind::Fading);
        let all = [
            (Kind::Run, run),
            (Kind::Mounting, mounting),
            (Kind::Position, position),
            (Kind::Node, node),
            (fast, flicker),
            (slow, flicker),
            (slowest, wander),
            (Kind::Walk, walk * 60.0),
            (Kind::Beginning, beginning),
            (Kind::Pose, pose),
        ];
        let matters = |&(_, sigma): &(Kind, f64)| sigma > self.sample * NOTHING;
        let state = |(kind, sigma): (Kind, f64)| State { kind, variance: sigma * sigma };
        let walk = |state: State| match state.kind {
            Kind::Walk => State { variance: state.variance / 3600.0, ..state },
            _ => state,
        };
        all.into_iter().filter(matters).map(state).map(walk).collect()
    }

    fn steps(&self, stretch: &Stretch, states: &[State]) -> (Vec<Step>, f64) {
        let count = states.len();
        let mut covariance = [[0.0; STATES]; STATES];
        let (mut log_det, mut last_s) = (0.0, 0.0);
        let mut steps = Vec::with_capacity(stretch.cells.len());
        for (index, cell) in stretch.cells.iter().enumerate() {
            let dt_s = (cell.time_s - last_s).max(0.0);
            last_s = cell.time_s;
            let kept = predict(&mut covariance, states, cell, dt_s, index == 0);
            let mut seen = [0.0; STATES];
            seen.iter_mut().zip(states).for_each(|(seen, state)| *seen = state.kind.seen(cell));
            let mut shared = [0.0; STATES];
            for i in 0..count {
                shared[i] = (0..count).map(|j| covariance[i][j] * seen[j]).sum();
            }
            let own = self.sample.powi(2) / cell.samples + (self.per_c * cell.unseen_c).powi(2);
            let variance = own + (0..count).map(|i| seen[i] * shared[i]).sum::<f64>();
            let gain = shared.map(|shared| shared / variance);
            for i in 0..count {
                for j in 0..count {
                    covariance[i][j] -= gain[i] * shared[j];
                }
            }
            log_det += variance.ln();
            steps.push(Step { seen, kept, gain, scale: variance.sqrt().recip() });
        }
        (steps, log_det)
    }
}

/// Below this share of the sample noise a part is left out.
const NOTHING: f64 = 0.021;

impl Kind {
    /// How it shows in a cell.
    fn seen(self, cell: &Cell) -> f64 {
        match self {
            Self::Mounting | Self::Position => cell.cross_g,
            Self::Beginning => cell.beginning,
            _ => 1.0,
        }
    }

    /// Which share of it is kept on the way to a cell.
    fn kept(self, cell: &Cell, dt_s: f64) -> f64 {
        match self {
            Self::Position | Self::Pose if cell.new_position => 0.0,
            Self::Node if cell.new_node => 0.0,
            Self::Fading(tau_s) => (-dt_s / tau_s).exp(),
            _ => 1.0,
        }
    }
}

/// Moves the states' covariance on to `cell`; returns which share of each state is kept.
fn predict(
    covariance: &mut [[f64; STATES]; STATES],
    states: &[State],
    cell: &Cell,
    dt_s: f64,
    first: bool,
) -> [f64; STATES] {
    let mut kept = [1.0; STATES];
    for (i, state) in states.iter().enumerate() {
        let walks = matches!(state.kind, Kind::Walk);
        if first {
            covariance[i][i] = if walks { 0.0 } else { state.variance };
            continue;
        }
        kept[i] = state.kind.kept(cell, dt_s);
        if kept[i] != 1.0 {
            (0..states.len()).for_each(|j| covariance[i][j] *= kept[i]);
            (0..states.len()).for_each(|j| covariance[j][i] *= kept[i]);
        }
        covariance[i][i] += if walks { state.variance * dt_s } else { state.variance * (1.0 - kept[i].powi(2)) };
    }
    kept
}

/// Filters so many columns at once.
fn filtered<const LANES: usize>(steps: &[Step], count: usize, values: &DMatrix<f64>) -> DMatrix<f64> {
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
            innovate(step, count, &mut states, &mut values);
            for lane in 0..lanes {
                target[lane * rows + row] = values[lane] * step.scale;
            }
        }
    }
    white
}

/// Turns values into what the past did not foretell, and learns from it.
fn innovate<const LANES: usize>(
    step: &Step,
    count: usize,
    states: &mut [[f64; LANES]; STATES],
    values: &mut [f64; LANES],
) {
    let shares = step.kept.iter().zip(&step.seen);
    for (state, (kept, seen)) in states.iter_mut().zip(shares).take(count) {
        for (state, value) in state.iter_mut().zip(values.iter_mut()) {
            *state *= kept;
            *value -= seen * *state;
        }
    }
    for (state, gain) in states.iter_mut().zip(&step.gain).take(count) {
        state.iter_mut().zip(values.iter()).for_each(|(state, value)| *state += gain * value);
    }
}
