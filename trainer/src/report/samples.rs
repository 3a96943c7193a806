//! Every sample's residual with everything that it may depend on.

use crate::campaign::Run;
use crate::residuals::{Residuals, RunResiduals};
use serde::Serialize;

/// A run as charts name it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunName {
    /// Its name.
    pub name: String,
    /// What it was.
    pub kind: String,
    /// Whether the training never saw it.
    pub held_out: bool,
}

impl RunName {
    /// Of a run.
    #[must_use]
    pub fn of(run: &Run, held_out: bool) -> Self {
        Self { name: run.name.clone(), kind: run.kind.clone(), held_out }
    }
}

/// One sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Its run, by its place in the campaign.
    pub run: u16,
    /// Reading minus reference, µg.
    pub residual_ug: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// How fast that changes, °C per minute, where neighbours tell.
    pub rate_c_per_min: Option<f64>,
    /// Since power-on, min.
    pub power_on_min: f64,
    /// Calendar age, days, where it is known.
    pub age_days: Option<f64>,
    /// Applied acceleration, g.
    pub level_g: f64,
    /// Frequency difference, Hz.
    pub delta_f_hz: f64,
}

/// A rate is the slope between samples up to this much before and after, s.
const RATE_REACH_US: u64 = 60_000_000;
/// Over less time than this there is no rate, s.
const RATE_LEAST_US: u64 = 10_000_000;
/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// All samples in the order of the runs.
#[must_use]
pub fn samples(residuals: &Residuals) -> Vec<Sample> {
    residuals.runs.iter().enumerate().flat_map(|(index, run)| of_run(index, run)).collect()
}

fn of_run<'a>(index: usize, run: &'a RunResiduals) -> impl Iterator<Item = Sample> + 'a {
    let rates = rates_c_per_min(run.run);
    run.run.rows.iter().zip(&run.residuals_g).zip(rates).map(move |((row, residual_g), rate_c_per_min)| Sample {
        run: u16::try_from(index).unwrap_or(u16::MAX),
        residual_ug: residual_g * 1e6,
        temperature_c: f64::from(row.sample.temperature_uc) * 1e-6,
        rate_c_per_min,
        power_on_min: row.sample.power_on_us as f64 / 60e6,
        age_days: row.sample.age_s.map(|age_s| f64::from(age_s) / DAY_S),
        level_g: row.reference_g,
        delta_f_hz: row.sample.delta_f_uhz as f64 * 1e-6,
    })
}

/// How fast the temperature changes at each row, from the slope across its neighbourhood.
fn rates_c_per_min(run: &Run) -> Vec<Option<f64>> {
    let rows = &run.rows;
    let (mut first, mut last) = (0, 0);
    let mut rate = |index: usize| {
        let now_us = rows[index].sample.time_us;
        while rows[first].sample.time_us + RATE_REACH_US < now_us {
            first += 1;
        }
        last = last.max(index);
        while rows.get(last + 1).is_some_and(|row| row.sample.time_us <= now_us + RATE_REACH_US) {
            last += 1;
        }
        let (from, to) = (&rows[first].sample, &rows[last].sample);
        let time_us = to.time_us - from.time_us;
        let change_uc = f64::from(to.temperature_uc) - f64::from(from.temperature_uc);
        (time_us >= RATE_LEAST_US).then(|| change_uc * 60.0 / time_us as f64)
    };
    (0..rows.len()).map(&mut rate).collect()
}
