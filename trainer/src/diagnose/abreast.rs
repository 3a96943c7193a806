//! What the filter sees of cells: how each part of the noise shows in them, and how much of it is kept on the way there.

use super::layout::{Cell, SLOWEST, WANDER_TAUS_S};
use super::whitening::NoiseModel;

/// How a part of the noise goes on from cell to cell, and how it shows.
#[derive(Clone, Copy)]
pub(super) enum Kind {
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
    /// Fades with one of the times of `layout::WANDER_TAUS_S`.
    Fading(usize),
    /// Fades within hours, per g across the input axis.
    Turning,
    /// A random walk.
    Walk,
    /// As much as is left of what the effect at a place brought along, from one of two ends.
    Beginning(usize, usize),
}

/// One cell of each of `L` runs, as the filter sees them; of a run that has ended nothing is seen, and all is kept.
pub(super) struct Abreast<'a, const L: usize> {
    cells: [Option<&'a Cell>; L],
    /// 1, or 0 of a run that has ended.
    present: [f64; L],
    cross_g: [f64; L],
    /// 0 where the sensor was moved, or the chamber was sent elsewhere.
    same_position: [f64; L],
    same_node: [f64; L],
    unfaded: [[f64; L]; WANDER_TAUS_S.len()],
    /// Time since the cells before, s.
    pub since_s: [f64; L],
    /// Variance of what a cell does not share with others.
    pub own: [f64; L],
}

impl<'a, const L: usize> Abreast<'a, L> {
    const ENDED: Self = Self {
        cells: [None; L],
        present: [0.0; L],
        cross_g: [0.0; L],
        same_position: [1.0; L],
        same_node: [1.0; L],
        unfaded: [[1.0; L]; WANDER_TAUS_S.len()],
        since_s: [0.0; L],
        own: [1.0; L],
    };

    /// These cells.
    pub fn new(noise: &NoiseModel, cells: [Option<&'a Cell>; L]) -> Self {
        let mut all = Self { cells, ..Self::ENDED };
        for (lane, cell) in cells.iter().enumerate().filter_map(|(lane, cell)| cell.map(|cell| (lane, cell))) {
            all.present[lane] = 1.0;
            all.cross_g[lane] = cell.cross_g;
            all.same_position[lane] = f64::from(u8::from(!cell.new_position));
            all.same_node[lane] = f64::from(u8::from(!cell.new_node));
            all.unfaded.iter_mut().zip(&cell.unfaded).for_each(|(all, unfaded)| all[lane] = *unfaded);
            all.since_s[lane] = cell.since_s;
            all.own[lane] = noise.sample.powi(2) / cell.samples + (noise.per_c * cell.unseen_c).powi(2);
        }
        all
    }

    /// How a part of the noise shows.
    pub fn seen(&self, kind: Kind) -> [f64; L] {
        match kind {
            Kind::Mounting | Kind::Position | Kind::Turning => self.cross_g,
            Kind::Beginning(place, end) => self.cells.map(|cell| cell.map_or(0.0, |cell| cell.beginnings[place][end])),
            _ => self.present,
        }
    }

    /// Which share of it is kept on the way to these cells.
    pub fn kept(&self, kind: Kind) -> [f64; L] {
        match kind {
            Kind::Position | Kind::Pose => self.same_position,
            Kind::Node => self.same_node,
            Kind::Fading(which) => self.unfaded[which],
            Kind::Turning => self.unfaded[SLOWEST],
            _ => [1.0; L],
        }
    }
}
