//! What noise looks like, and how it is taken out of the way.
//!
//! A residual is not white: flicker and random walk make neighbours alike, a table error shifts a position, a
//! soak that is not quite like the last one shifts a node, a mounting shifts a run in proportion to the
//! acceleration across the input axis, a start shifts a run. An effect is judged by what it explains beyond all
//! that. The noise is a sum of states that a Kalman filter tracks; its innovations are white, and every column
//! that goes through the same filter can be compared by plain least squares.

use super::abreast::Kind;
use super::beginning::BEGINNINGS;
use super::filter::{self, Pass, State};
use super::layout::{Layout, SLOWEST, Stretch};
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
pub(super) const PARTS: usize = BEGINNING + BEGINNINGS;
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
/// From position to position, whatever acceleration lies across the input axis: no table does that.
pub(super) const POSE: usize = 7;
/// Wander within hours, per g across the input axis: at one level a rig stands in two ways, and nobody wrote down in which.
pub(super) const TURN: usize = 8;
/// What effects with a memory brought along from before the run: here the first's, then the others'.
pub(super) const BEGINNING: usize = 9;

/// A noise on its way through all runs, ready for any column.
pub(super) struct Whitening {
    passes: Vec<Box<dyn Pass>>,
    /// Logarithm of the determinant of the noise's covariance.
    pub log_det: f64,
}

impl Whitening {
    /// The columns with the noise's correlation taken out: white with variance one.
    pub fn of(&self, columns: &Columns) -> Columns {
        let pairs: Vec<_> = self.passes.iter().zip(columns).collect();
        pairs.into_par_iter().map(|(pass, values)| pass.whitened(values)).collect()
    }

    /// The same of one run.
    pub fn of_run(&self, run: usize, columns: &DMatrix<f64>) -> DMatrix<f64> {
        self.passes[run].whitened(columns)
    }
}

/// A small random walk adds this share of the sample noise in a second.
const SMALL_WALK: f64 = 0.01;

impl NoiseModel {
    /// What takes the noise's correlation out of columns.
    pub fn whitening(&self, layout: &Layout) -> Whitening {
        let states = self.states(layout);
        let pass = |stretch: &Stretch| filter::pass(self, &states, stretch);
        let passes: Vec<_> = layout.stretches.par_iter().map(pass).collect();
        let log_det = passes.iter().map(|pass| pass.log_det()).sum();
        Whitening { passes, log_det }
    }

    /// Minus twice the logarithm of the likelihood of one column, but for a constant.
    pub fn deviance(&self, layout: &Layout, column: &Columns) -> f64 {
        let states = self.states(layout);
        let mut runs: Vec<_> = layout.stretches.iter().zip(column.iter().map(DMatrix::as_slice)).collect();
        // Runs of like length go together.
        runs.sort_by_key(|(stretch, _)| std::cmp::Reverse(stretch.cells.len()));
        let some = runs.par_chunks(filter::RUNS).map(|some| filter::deviance(self, &states, some));
        // Summed in order: the same on any number of threads.
        some.collect::<Vec<f64>>().iter().sum()
    }

    /// The same with no part larger than the sample noise.
    pub fn small(&self) -> Self {
        let mut small = *self;
        small.parts.iter_mut().for_each(|part| *part = part.min(self.sample));
        small.parts[WALK] = small.parts[WALK].min(self.sample * SMALL_WALK);
        small.parts[BEGINNING..].copy_from_slice(&self.parts[BEGINNING..]);
        small
    }

    /// The same with no wander larger than the sample noise: what swings is taken for wander otherwise.
    pub fn calm(&self) -> Self {
        let mut calm = *self;
        let small = self.small();
        [FLICKER, WANDER, WALK, TURN].into_iter().for_each(|part| calm.parts[part] = small.parts[part]);
        calm
    }

    /// The states that make a difference.
    fn states(&self, layout: &Layout) -> Vec<State> {
        let [run, mounting, position, node, flicker, wander, walk, pose, turn, ..] = self.parts;
        let all = [
            (Kind::Constant, run),
            (Kind::Mounting, mounting),
            (Kind::Position, position),
            (Kind::Node, node),
            (Kind::Fading(0), flicker),
            (Kind::Fading(1), flicker),
            (Kind::Fading(SLOWEST), wander),
            (Kind::Walk, walk * 60.0),
            (Kind::Pose, pose),
            (Kind::Turning, turn),
        ];
        let matters = |&(_, sigma): &(Kind, f64)| sigma > self.sample * NOTHING;
        let state = |(kind, sigma): (Kind, f64)| State { kind, variance: sigma * sigma };
        let walk = |state: State| match state.kind {
            Kind::Walk => State { variance: state.variance / 3600.0, ..state },
            _ => state,
        };
        let began = |&(place, end)| (Kind::Beginning(place, end), self.parts[BEGINNING + place]);
        all.into_iter().chain(layout.remembered.iter().map(began)).filter(matters).map(state).map(walk).collect()
    }
}

/// Below this share of the sample noise a part is left out.
const NOTHING: f64 = 0.021;
