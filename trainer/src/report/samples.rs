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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Row;
    use std::path::PathBuf;

    fn run(times_s: &[u64], temperature_c: impl Fn(u64) -> f64) -> Run {
        let row = |&second: &u64| Row {
            sample: protocol::Sample::from_difference(second * 1_000_000, 0, (temperature_c(second) * 1e6) as i32),
            reference_g: 0.0,
            reference_sigma_g: None,
        };
        let (name, kind) = ("ramp".to_owned(), "ramp".to_owned());
        Run { name, kind, source: PathBuf::new(), rows: times_s.iter().map(row).collect() }
    }

    #[test]
    fn a_ramp_has_its_rate_everywhere_and_a_gap_has_none() {
        let every_10_s: Vec<u64> = (0..30).map(|k| k * 10).collect();
        let rates = rates_c_per_min(&run(&every_10_s, |second| second as f64 / 120.0));
        assert!(rates.iter().all(|rate| rate.is_some_and(|rate| (rate - 0.5).abs() < 1e-3)), "{rates:?}");
        // Two nodes an hour apart, half a minute each: the change between them is nobody's rate.
        let nodes: Vec<u64> =
            (0..4).chain(3600..3604).map(|k| if k < 3600 { k * 10 } else { 3600 + (k - 3600) * 10 }).collect();
        let rates = rates_c_per_min(&run(&nodes, |second| if second < 3600 { 20.0 } else { 40.0 }));
        assert!(rates.iter().all(|rate| *rate == Some(0.0)), "{rates:?}");
        assert_eq!(rates_c_per_min(&run(&[0, 300], |_| 20.0)), [None, None]);
    }
}
