//! One cell: the mean of neighbouring samples at one position.

use crate::diagnose::thresholds::WANDER_TAUS_S;
use std::ops::Range;

/// One cell: the mean of neighbouring samples at one position.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Its rows within the run.
    pub rows: Range<usize>,
    /// Samples.
    pub samples: f64,
    /// Mean time from the run's first row, s.
    pub time_s: f64,
    /// Time since the cell before, s.
    pub since_s: f64,
    /// Autocorrelation since then of a wander with each of [`WANDER_TAUS_S`].
    pub correlation: [f64; WANDER_TAUS_S.len()],
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
            correlation: WANDER_TAUS_S.map(|tau_s| (-since_s / tau_s).exp()),
            x: 0.0,
            t: 0.0,
            level_g: 0.0,
            cross_g: 1.0,
            unseen_c: 0.0,
            new_node: false,
            new_position: false,
        }
    }
}

/// The last of them.
pub const SLOWEST: usize = 2;
