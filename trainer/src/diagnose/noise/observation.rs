//! What the filter sees of cells: how each part of the noise shows in them, and how much of it is kept on the way there.

use super::components::NoiseModel;
use super::initial_state::{NOTHING, Shares};
use crate::diagnose::cells::{Cell, RunCells, SLOWEST};
use crate::diagnose::thresholds::WANDER_TAUS_S;

/// How a part of the noise goes on from cell to cell, and how it shows.
#[derive(Clone, Copy)]
pub enum Kind {
    /// The same throughout a run.
    Constant,
    /// Throughout a run, per g across the input axis.
    Mounting,
    /// New at every position, per g across the input axis.
    Position,
    /// New at every position.
    Pose,
    /// New at every soaked node.
    Node,
    /// Fades with one of the times of `WANDER_TAUS_S`.
    Fading(usize),
    /// Fades within hours, per g across the input axis.
    Turning,
    /// A random walk.
    Walk,
    /// As much as is left of the initial state of the effect at a place, in one of two ways.
    Initial(usize, usize),
}

/// A run's cells, and how much of the initial states is left in them.
#[derive(Clone, Copy)]
pub struct Observed<'a> {
    /// The run.
    pub run: &'a RunCells<'a>,
    /// Cell by cell; empty where nothing is remembered.
    pub initial: &'a [Shares],
}

/// One of them.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// What is left of the initial states.
    pub initial: &'a Shares,
}

impl<'a> Observed<'a> {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.run.cells.len()
    }

    /// The cell at `index`; none beyond the end of the run.
    pub fn seen(&self, index: usize) -> Option<Seen<'a>> {
        let cell = self.run.cells.get(index)?;
        Some(Seen { cell, initial: self.initial.get(index).unwrap_or(&NOTHING) })
    }
}

/// One cell of each of `L` runs, as the filter sees them; of a run that has ended nothing is seen, and all is kept.
pub struct Lanes<'a, const L: usize> {
    initial: [&'a Shares; L],
    /// 1, or 0 of a run that has ended.
    present: [f64; L],
    cross_g: [f64; L],
    /// 0 where the sensor was moved, or the chamber was sent elsewhere.
    same_position: [f64; L],
    same_node: [f64; L],
    correlation: [[f64; L]; WANDER_TAUS_S.len()],
    /// Time since the cells before, s.
    pub since_s: [f64; L],
    /// Variance of what a cell does not share with others.
    pub own: [f64; L],
}

impl<'a, const L: usize> Lanes<'a, L> {
    const ENDED: Self = Self {
        initial: [&NOTHING; L],
        present: [0.0; L],
        cross_g: [0.0; L],
        same_position: [1.0; L],
        same_node: [1.0; L],
        correlation: [[1.0; L]; WANDER_TAUS_S.len()],
        since_s: [0.0; L],
        own: [1.0; L],
    };

    /// These cells.
    pub fn new(noise: &NoiseModel, cells: [Option<Seen<'a>>; L]) -> Self {
        let mut all = Self::ENDED;
        let present = cells.into_iter().enumerate().filter_map(|(lane, seen)| seen.map(|seen| (lane, seen)));
        for (lane, Seen { cell, initial }) in present {
            all.initial[lane] = initial;
            all.present[lane] = 1.0;
            all.cross_g[lane] = cell.cross_g;
            all.same_position[lane] = f64::from(u8::from(!cell.new_position));
            all.same_node[lane] = f64::from(u8::from(!cell.new_node));
            all.correlation.iter_mut().zip(&cell.correlation).for_each(|(all, correlation)| all[lane] = *correlation);
            all.since_s[lane] = cell.since_s;
            all.own[lane] = noise.sample.powi(2) / cell.samples + (noise.per_c * cell.unseen_c).powi(2);
        }
        all
    }

    /// How a part of the noise shows.
    pub fn seen(&self, kind: Kind) -> [f64; L] {
        match kind {
            Kind::Mounting | Kind::Position | Kind::Turning => self.cross_g,
            Kind::Initial(place, way) => self.initial.map(|shares| shares[place][way]),
            Kind::Constant | Kind::Pose | Kind::Node | Kind::Fading(_) | Kind::Walk => self.present,
        }
    }

    /// Which share of it is kept on the way to these cells.
    pub fn kept(&self, kind: Kind) -> [f64; L] {
        match kind {
            Kind::Position | Kind::Pose => self.same_position,
            Kind::Node => self.same_node,
            Kind::Fading(which) => self.correlation[which],
            Kind::Turning => self.correlation[SLOWEST],
            Kind::Constant | Kind::Mounting | Kind::Walk | Kind::Initial(..) => [1.0; L],
        }
    }
}
