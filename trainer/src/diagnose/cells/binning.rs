//! From the rows of a run to its cells: means, times, and where the sensor or the chamber was moved.

use super::cell::Cell;
use crate::campaign::Run;
use crate::diagnose::thresholds::{NODE_STEP_C, REST_C_PER_S, SAME_POSITION_G, WANDER_TAUS_S};
use crate::fit::dataset::{InputScale, mean};
use std::ops::Range;

/// How it is known what lies across the input axis.
#[derive(Clone, Copy, Debug)]
pub struct Across {
    /// Index of the channel that says it.
    pub channel: Option<usize>,
    /// What 1 g is in the level's unit; none where nothing is left of gravity across.
    pub gravity: Option<f64>,
}

impl Across {
    /// At this level, g.
    fn g(&self, level: f64) -> f64 {
        self.gravity.map_or(1.0, |gravity| across_g(level / gravity))
    }
}

/// What is left of gravity across the input axis, g.
pub fn across_g(level_g: f64) -> f64 {
    (1.0 - level_g * level_g).max(0.0).sqrt()
}

/// The cells of a run, each of these rows.
pub fn cells_of(run: &Run, rows: Vec<Range<usize>>, scale: &InputScale, across: Across) -> Vec<Cell> {
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
            correlation: WANDER_TAUS_S.map(|tau_s| (-since_s / tau_s).exp()),
            x: datum.x,
            t: datum.t,
            level_g,
            cross_g: cross_ug.map_or_else(|| across.g(level_g), |ug| ug as f64 * 1e-6),
            unseen_c: (rows.clone().map(|row| unseen_c(run, row).powi(2)).sum::<f64>() / datum.weight).sqrt(),
            new_node: false,
            new_position: found.last().is_none_or(moved) || turned,
            rows,
        });
        last_cross_ug = cross_ug.unwrap_or_default();
    }
    mark_nodes(run, &mut found);
    found
}

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
