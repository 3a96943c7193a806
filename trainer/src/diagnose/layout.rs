//! The campaign as a diagnosis sees it: cells of neighbouring samples, run by run, with what noise may depend on.

use super::beginning::{self, BEGINNINGS, Beginning, FORGOTTEN};
use super::gathered::Gathered;
use super::instrument::Known;
use crate::campaign::{Campaign, Run};
use crate::fit::dataset::{InputScale, mean};
use crate::fit::neighbours::Neighbours;
use crate::yardstick::STILL;
use firmware_core::Memory;
use std::ops::{Range, RangeInclusive};

/// One cell: the mean of neighbouring samples at one position.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Its rows within the run.
    pub rows: Range<usize>,
    /// Samples.
    pub samples: f64,
    /// Mean time from the run's first row, s.
    pub time_s: f64,
    /// Time since the cell before, s.
    pub since_s: f64,
    /// What is left since then of a wander with each of [`WANDER_TAUS_S`].
    pub unfaded: [f64; WANDER_TAUS_S.len()],
    /// Scaled frequency difference.
    pub x: f64,
    /// Scaled temperature.
    pub t: f64,
    /// Applied acceleration, g.
    pub level_g: f64,
    /// Acceleration across the input axis, g: the channel's, or else what is left of 1 g.
    pub cross_g: f64,
    /// How far the temperature may have gone astray unseen: coarse sampling of a bent course, or a beginning under way, °C.
    pub unseen_c: f64,
    /// Of what effects with a memory brought along, how much is still there.
    pub beginnings: [Beginning; BEGINNINGS],
    /// Whether the chamber was sent elsewhere, or arrived there, since the cell before.
    pub new_node: bool,
    /// Whether the sensor was moved since the cell before.
    pub new_position: bool,
}

#[cfg(test)]
impl Cell {
    /// One sample of many at rest, `since_s` after the last one.
    pub fn plain(index: usize, time_s: f64, since_s: f64) -> Self {
        Self {
            rows: index..index + 1,
            samples: 1.0,
            time_s,
            since_s,
            unfaded: WANDER_TAUS_S.map(|tau_s| (-since_s / tau_s).exp()),
            x: 0.0,
            t: 0.0,
            level_g: 0.0,
            cross_g: 1.0,
            unseen_c: 0.0,
            beginnings: [FORGOTTEN; BEGINNINGS],
            new_node: false,
            new_position: false,
        }
    }
}

/// Correlation times of the noise's wander, s: two octaves of flicker, and what takes hours.
pub(super) const WANDER_TAUS_S: [f64; 3] = [60.0, 600.0, 5000.0];
/// The last of them.
pub(super) const SLOWEST: usize = 2;

/// One run in cells.
#[derive(Clone, Debug)]
pub(super) struct Stretch<'a> {
    /// The run.
    pub run: &'a Run,
    /// Its cells in order.
    pub cells: Vec<Cell>,
    /// Its rows, gathered within the cells.
    pub gathered: Gathered,
}

/// All runs in cells.
#[derive(Clone, Debug)]
pub(super) struct Layout<'a> {
    /// Run by run.
    pub stretches: Vec<Stretch<'a>>,
    /// From integers to x and t.
    pub scale: InputScale,
    /// Longest gap across which a memory is carried, µs.
    pub max_gap_us: u32,
    /// Place and end of the beginnings that are there in any cell.
    pub remembered: Vec<(usize, usize)>,
    /// What lies across the input axis, and how it is known.
    across: Across,
    /// Whether the reference never varies.
    still: bool,
}

/// How it is known what lies across the input axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    /// Index of the channel that says it.
    channel: Option<usize>,
    /// What 1 g is in the level's unit; none where nothing is left of gravity across.
    gravity: Option<f64>,
}

impl Across {
    /// At this level, g.
    fn g(&self, level: f64) -> f64 {
        self.gravity.map_or(1.0, |gravity| across_g(level / gravity))
    }
}

impl<'a> Stretch<'a> {
    fn new(run: &'a Run, rows: Vec<Range<usize>>, scale: &InputScale, across: Across) -> Self {
        let gathered = Gathered::new(&run.rows, rows.iter());
        Self { run, cells: cells_of(run, rows, scale, across), gathered }
    }

    /// Whether the sensor was moved during the run.
    pub fn is_moved(&self) -> bool {
        self.cells.iter().skip(1).any(|cell| cell.new_position)
    }
}

/// References closer than this are the same position, g.
const SAME_POSITION_G: f64 = 1e-3;
/// The channel that says how much acceleration lies across the input axis.
pub(super) const CROSS_CHANNEL: &str = "cross_g";

impl<'a> Layout<'a> {
    /// The cells of every run of the campaign, whose reading goes to either side by `reach` and for which gravity is as
    /// large as it says.
    pub fn new(campaign: &'a Campaign, scale: InputScale, max_gap_us: u32, reach: f64, gravity: Option<f64>) -> Self {
        let channel = campaign.channels.iter().position(|channel| channel == CROSS_CHANNEL);
        let still = is_still(campaign, reach);
        // At rest all lies across, or nothing of note changes there.
        let across = Across { channel, gravity: gravity.filter(|_| !still) };
        let neighbours = Neighbours::of(&campaign.runs, &scale);
        let stretch = |run: &'a Run| Stretch::new(run, neighbours.cells(run), &scale, across);
        let stretches = campaign.runs.iter().map(stretch).collect();
        Self { stretches, scale, max_gap_us, remembered: Vec::new(), across, still }
    }

    /// The same with a cell for every sample.
    pub fn by_sample(&self) -> Self {
        let rows = |run: &Run| (0..run.rows.len()).map(|row| row..row + 1).collect();
        let stretch = |one: &Stretch<'a>| Stretch::new(one.run, rows(one.run), &self.scale, self.across);
        Self { stretches: self.stretches.iter().map(stretch).collect(), remembered: Vec::new(), ..*self }
    }

    /// Marks how much of what the effects' memories brought along from before each run is still there.
    pub fn remember(&mut self, known: &Known) {
        for stretch in &mut self.stretches {
            stretch.cells.iter_mut().for_each(|cell| cell.beginnings = [FORGOTTEN; BEGINNINGS]);
            let memories = known.memories().filter(|memory| *memory != Memory::None);
            memories.enumerate().for_each(|(at, memory)| beginning::mark(stretch, at.min(BEGINNINGS - 1), memory));
        }
        let is_there = |(place, end): &(usize, usize)| self.cells().any(|cell| cell.beginnings[*place][*end] > 0.0);
        let all = (0..BEGINNINGS).flat_map(|place| (0..FORGOTTEN.len()).map(move |end| (place, end)));
        self.remembered = all.filter(is_there).collect();
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.stretches.iter().map(|stretch| stretch.cells.len()).sum()
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
            self.cells().fold((f64::MAX, f64::MIN), |(low, high), cell| (low.min(cell.t), high.max(cell.t)));
        let at = |t: f64| zero_c + t * self.scale.temperature_half_span_c;
        at(low)..=at(high)
    }

    /// All cells in order.
    pub fn cells(&self) -> impl Iterator<Item = &Cell> {
        self.stretches.iter().flat_map(|stretch| &stretch.cells)
    }
}

fn is_still(campaign: &Campaign, reach: f64) -> bool {
    let levels = || campaign.rows().map(|row| row.reference_g);
    let (low, high) = (levels().fold(f64::INFINITY, f64::min), levels().fold(f64::NEG_INFINITY, f64::max));
    high / 2.0 - low / 2.0 <= STILL * reach
}

/// What is left of gravity across the input axis, g.
pub(super) fn across_g(level_g: f64) -> f64 {
    (1.0 - level_g * level_g).max(0.0).sqrt()
}

fn cells_of(run: &Run, rows: Vec<Range<usize>>, scale: &InputScale, across: Across) -> Vec<Cell> {
    let start_us = run.rows.first().map_or(0, |row| row.sample.time_us);
    let mut found: Vec<Cell> = Vec::new();
    let mut last_cross_ug = 0;
    for rows in rows {
        let datum = mean(&run.rows[rows.clone()], 0, scale);
        let times = run.rows[rows.clone()].iter().map(|row| (row.sample.time_us - start_us) as f64 * 1e-6);
        let cross_ug = across.channel.map(|channel| run.rows[rows.start].sample.channels[channel]);
        let level_g = datum.reference_g;
        let moved = |last: &Cell| (last.level_g - level_g).abs() > SAME_POSITION_G;
        let turned = cross_ug.is_some_and(|cross_ug| cross_ug.abs_diff(last_cross_ug) > 1000);
        let time_s = times.sum::<f64>() / datum.weight;
        let since_s = (time_s - found.last().map_or(0.0, |last| last.time_s)).max(0.0);
        found.push(Cell {
            samples: datum.weight,
            time_s,
            since_s,
            unfaded: WANDER_TAUS_S.map(|tau_s| (-since_s / tau_s).exp()),
            x: datum.x,
            t: datum.t,
            level_g,
            cross_g: cross_ug.map_or_else(|| across.g(level_g), |ug| ug as f64 * 1e-6),
            unseen_c: (rows.clone().map(|row| unseen_c(run, row).powi(2)).sum::<f64>() / datum.weight).sqrt(),
            beginnings: [FORGOTTEN; BEGINNINGS],
            new_node: false,
            new_position: found.last().is_none_or(moved) || turned,
            rows,
        });
        last_cross_ug = cross_ug.unwrap_or_default();
    }
    mark_nodes(run, &mut found);
    found
}

/// Slower changes of temperature count as rest, °C/s.
const REST_C_PER_S: f64 = 0.1 / 60.0;
/// A change that nobody saw is a new node beyond this, °C.
const NODE_STEP_C: f64 = 3.0;

/// Where rest becomes motion, motion rest, or the temperature leaps.
fn mark_nodes(run: &Run, cells: &mut [Cell]) {
    let temperature_c = |row: usize| f64::from(run.rows[row].sample.temperature_uc) * 1e-6;
    let time_s = |row: usize| run.rows[row].sample.time_us as f64 * 1e-6;
    let mut last: Option<(usize, i32)> = None;
    for cell in cells {
        let (first, end) = (cell.rows.start, cell.rows.end.min(run.rows.len() - 1));
        let seconds = time_s(end) - time_s(first);
        let rate = if seconds > 0.0 { (temperature_c(end) - temperature_c(first)) / seconds } else { 0.0 };
        let motion = if rate.abs() < REST_C_PER_S { 0 } else { rate.signum() as i32 };
        cell.new_node = last.is_some_and(|(row, before)| {
            motion != before || (motion == 0 && (temperature_c(first) - temperature_c(row)).abs() > NODE_STEP_C)
        });
        last = Some((cell.rows.end - 1, motion));
    }
}

/// By how much a straight line between samples may miss the temperature around this row, °C; at the beginning, what one
/// more interval at the same rate would have been.
fn unseen_c(run: &Run, row: usize) -> f64 {
    let interval = |from: usize| {
        let (a, b) = (run.rows.get(from)?.sample, run.rows.get(from + 1)?.sample);
        let seconds = b.time_us.saturating_sub(a.time_us) as f64 * 1e-6;
        let warmer_c = (f64::from(b.temperature_uc) - f64::from(a.temperature_uc)) * 1e-6;
        Some((warmer_c, seconds.max(f64::MIN_POSITIVE)))
    };
    match (row.checked_sub(1).and_then(interval), interval(row)) {
        (Some((before_c, before_s)), Some((after_c, after_s))) => {
            (after_c / after_s - before_c / before_s).abs() * before_s.min(after_s) / 8.0
        }
        (None, Some((after_c, _))) => after_c.abs(),
        _ => 0.0,
    }
}
