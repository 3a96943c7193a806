//! The campaign as a diagnosis sees it: cells of neighbouring samples, run by run.

mod binning;
mod cell;
mod columns;
mod groups;

pub(super) use binning::across_g;
pub(super) use cell::{Cell, SLOWEST};
pub(super) use columns::{Columns, difference, generous, joined, product, stacked, width};
pub(super) use groups::Groups;

use crate::campaign::{Campaign, Run};
use crate::fit::dataset::InputScale;
use crate::fit::neighbours::Neighbours;
use crate::yardstick::STILL;
use binning::{Across, cells_of};
use nalgebra::DMatrix;
use std::ops::{Range, RangeInclusive};

/// One run in cells.
#[derive(Clone, Debug)]
pub(super) struct RunCells<'a> {
    /// The run.
    pub run: &'a Run,
    /// Its cells in order.
    pub cells: Vec<Cell>,
    /// Its rows in groups within the cells.
    pub groups: Groups,
}

/// All runs in cells.
#[derive(Clone, Debug)]
pub(super) struct Cells<'a> {
    /// Run by run.
    pub runs: Vec<RunCells<'a>>,
    /// From integers to x and t.
    pub scale: InputScale,
    /// Longest gap across which a memory is carried, µs.
    pub max_gap_us: u32,
    /// What lies across the input axis, and how it is known.
    across: Across,
    /// Whether the reference never varies.
    still: bool,
}

impl<'a> RunCells<'a> {
    fn new(run: &'a Run, rows: Vec<Range<usize>>, scale: &InputScale, across: Across) -> Self {
        let groups = Groups::new(&run.rows, rows.iter());
        Self { run, cells: cells_of(run, rows, scale, across), groups }
    }

    /// Whether the sensor was moved during the run.
    pub fn is_moved(&self) -> bool {
        self.cells.iter().skip(1).any(|cell| cell.new_position)
    }
}

/// The channel that says how much acceleration lies across the input axis.
pub(super) const CROSS_CHANNEL: &str = "cross_g";

impl<'a> Cells<'a> {
    /// The cells of every run of the campaign, whose reading goes to either side by `reach` and for which gravity is as
    /// large as it says.
    pub fn new(campaign: &'a Campaign, scale: InputScale, max_gap_us: u32, reach: f64, gravity: Option<f64>) -> Self {
        let channel = campaign.channels.iter().position(|channel| channel == CROSS_CHANNEL);
        let still = is_still(campaign, reach);
        // At rest all lies across, or nothing of note changes there.
        let across = Across { channel, gravity: gravity.filter(|_| !still) };
        let neighbours = Neighbours::of(&campaign.runs, &scale);
        let binned = |run: &'a Run| RunCells::new(run, neighbours.cells(run), &scale, across);
        let runs = campaign.runs.iter().map(binned).collect();
        Self { runs, scale, max_gap_us, across, still }
    }

    /// The same with a cell for every sample.
    pub fn by_sample(&self) -> Self {
        let rows = |run: &Run| (0..run.rows.len()).map(|row| row..row + 1).collect();
        let binned = |one: &RunCells<'a>| RunCells::new(one.run, rows(one.run), &self.scale, self.across);
        Self { runs: self.runs.iter().map(binned).collect(), ..*self }
    }

    /// Time between two samples where they come fastest, s: the least of the runs' medians; 0 where there are no two.
    pub fn interval_s(&self) -> f64 {
        self.runs.iter().filter_map(|run| run.run.sample_interval_s()).min_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.runs.iter().map(|run| run.cells.len()).sum()
    }

    /// Whether the reference never varies.
    pub fn is_still(&self) -> bool {
        self.still
    }

    /// Whether the rig may have been turned over unseen: at one level it stands in two ways.
    pub fn may_turn_unseen(&self) -> bool {
        self.across.channel.is_none() && self.across.gravity.is_some()
    }

    /// From the lowest to the highest temperature, °C.
    pub fn range_c(&self) -> RangeInclusive<f64> {
        let zero_c = f64::from(self.scale.temperature_zero_uc) * 1e-6;
        let (low, high) =
            self.iter().fold((f64::MAX, f64::MIN), |(low, high), cell| (low.min(cell.t), high.max(cell.t)));
        let at = |t: f64| zero_c + t * self.scale.temperature_half_span_c;
        at(low)..=at(high)
    }

    /// Columns with a value in each cell, in the unit of `of`: of each run cells × `N`.
    pub fn columns<const N: usize>(&self, of: impl Fn(usize, &RunCells, &Cell) -> [f64; N]) -> Columns {
        let run = |(index, run): (usize, &RunCells)| {
            let rows = run.cells.iter().flat_map(|cell| of(index, run, cell));
            DMatrix::from_row_iterator(run.cells.len(), N, rows)
        };
        self.runs.iter().enumerate().map(run).collect()
    }

    /// RMS over the samples of a course, in its unit: of each run cells × 1.
    pub fn rms(&self, course: &Columns) -> f64 {
        let pairs = self.iter().zip(course.iter().flat_map(|run| run.iter()));
        let (squares, samples) = pairs
            .fold((0.0, 0.0), |(sum, all), (cell, value)| (sum + cell.samples * value * value, all + cell.samples));
        (squares / f64::max(samples, 1.0)).sqrt()
    }

    /// Correlation of two courses over the samples: of each run cells × 1.
    pub fn correlation(&self, one: &Columns, other: &Columns) -> f64 {
        let values = || one.iter().flat_map(|run| run.iter()).zip(other.iter().flat_map(|run| run.iter()));
        let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            self.iter().zip(values()).map(|(cell, (one, other))| cell.samples * of(*one, *other)).sum()
        };
        let samples = sum(&|_, _| 1.0).max(1.0);
        let [mean, other_mean] = [sum(&|one, _| one), sum(&|_, other| other)].map(|sum| sum / samples);
        let covariance = sum(&|one, other| (one - mean) * (other - other_mean));
        let squares = sum(&|one, _| (one - mean).powi(2)) * sum(&|_, other| (other - other_mean).powi(2));
        if squares > 0.0 { covariance / squares.sqrt() } else { 0.0 }
    }

    /// All cells in order.
    pub fn iter(&self) -> impl Iterator<Item = &Cell> {
        self.runs.iter().flat_map(|run| &run.cells)
    }
}

fn is_still(campaign: &Campaign, reach: f64) -> bool {
    let levels = || campaign.rows().map(|row| row.reference_g);
    let (low, high) = (levels().fold(f64::INFINITY, f64::min), levels().fold(f64::NEG_INFINITY, f64::max));
    high / 2.0 - low / 2.0 <= STILL * reach
}
