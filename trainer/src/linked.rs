//! Samples for plots that are linked: the same samples against every axis, few enough to be drawn, and what a choice
//! among all of them amounts to.

use crate::campaign::Campaign;
use crate::report::samples;
use crate::residuals::Residuals;
use serde::{Deserialize, Serialize};

/// Names of the columns, in their order.
pub const COLUMNS: [&str; 8] =
    ["run", "temperature_c", "rate_c_per_min", "power_on_min", "age_days", "level_g", "delta_f_hz", "time_h"];
/// The column of the run.
const RUN: usize = 0;
/// What a range calls the residual of the first model.
pub const RESIDUAL: &str = "residual_ug";

/// Everything that a residual may depend on, column by column over all samples; NaN where nothing is known.
#[derive(Clone, Debug)]
pub struct Columns {
    /// In the order of [`COLUMNS`].
    pub values: [Vec<f32>; COLUMNS.len()],
    /// Where each run lies when the runs are laid end to end.
    pub places: Vec<Place>,
}

/// A run among the runs laid end to end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Begins, h.
    pub from_h: f64,
    /// Ends, h.
    pub to_h: f64,
    /// Position of its first sample among all.
    pub first: usize,
}

/// A stretch of one column.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// One of [`COLUMNS`], or [`RESIDUAL`].
    pub column: String,
    /// From here on; open where absent.
    pub low: Option<f32>,
    /// Up to here; open where absent.
    pub high: Option<f32>,
}

/// What a choice amounts to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// Samples chosen.
    pub samples: usize,
    /// Out of so many.
    pub of: usize,
    /// Model by model.
    pub models: Vec<Figures>,
    /// The runs that they belong to, most samples first.
    pub runs: Vec<Share>,
}

/// The residual of the chosen samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Root mean square, µg.
    pub rms_ug: f64,
    /// Mean, µg.
    pub mean_ug: f64,
}

/// One run's share of a choice.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Share {
    /// The run.
    pub run: String,
    /// Its samples among the chosen.
    pub samples: usize,
}

impl Columns {
    /// Of every sample that has a residual.
    #[must_use]
    pub fn of(residuals: &Residuals) -> Self {
        let mut columns = Self { values: std::array::from_fn(|_| Vec::new()), places: places(residuals) };
        let times = residuals.runs.iter().zip(&columns.places).flat_map(|(run, place)| {
            let first_us = run.run.rows.first().map_or(0, |row| row.sample.time_us);
            let since = move |time_us: u64| place.from_h + time_us.saturating_sub(first_us) as f64 / HOUR_US;
            run.run.rows.iter().map(move |row| since(row.sample.time_us))
        });
        for (sample, time_h) in samples(residuals).iter().zip(times) {
            let row = [
                f64::from(sample.run),
                sample.temperature_c,
                sample.rate_c_per_min.unwrap_or(f64::NAN),
                sample.power_on_min,
                sample.age_days.unwrap_or(f64::NAN),
                sample.level_g,
                sample.delta_f_hz,
                time_h,
            ];
            for (column, value) in columns.values.iter_mut().zip(row) {
                column.push(value as f32);
            }
        }
        columns
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values[RUN].len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Which samples to draw, ascending, so that they are about `most`: all, or of each so many that follow each other
    /// in a run those with the lowest and the highest residual of every model. Returns how many follow each other.
    #[must_use]
    pub fn drawn(&self, residuals_ug: &[&[f32]], most: usize) -> (Vec<usize>, usize) {
        let rows = self.len();
        if rows <= most {
            return ((0..rows).collect(), 1);
        }
        let stride = (2 * residuals_ug.len().max(1) * rows).div_ceil(most.max(1));
        let mut kept = Vec::new();
        for (place, end) in self.places.iter().zip(self.ends()) {
            for start in (place.first..end).step_by(stride) {
                let part = start..end.min(start + stride);
                let by = |residuals: &[f32]| {
                    let order = |a: &usize, b: &usize| residuals[*a].total_cmp(&residuals[*b]);
                    [part.clone().min_by(order), part.clone().max_by(order)]
                };
                let mut extremes: Vec<usize> = residuals_ug.iter().flat_map(|r| by(r)).flatten().collect();
                extremes.sort_unstable();
                extremes.dedup();
                kept.extend(extremes);
            }
        }
        (kept, stride)
    }

    fn ends(&self) -> impl Iterator<Item = usize> {
        self.places.iter().skip(1).map(|place| place.first).chain([self.len()])
    }

    /// What the samples within all ranges, of the runs that `wanted` names, amount to.
    #[must_use]
    pub fn chosen(
        &self,
        campaign: &Campaign,
        residuals_ug: &[&[f32]],
        ranges: &[Range],
        wanted: impl Fn(&str) -> bool,
    ) -> Chosen {
        let wanted: Vec<bool> = campaign.runs.iter().map(|run| wanted(&run.name)).collect();
        let run_of = |row: usize| self.values[RUN][row] as usize;
        let within: Vec<(&[f32], f32, f32)> =
            ranges.iter().filter_map(|range| self.limits(range, residuals_ug)).collect();
        let is_wanted = |row: &usize| wanted.get(run_of(*row)).copied().unwrap_or(false);
        let rows: Vec<usize> = (0..self.len()).filter(is_wanted).collect();
        let is_within = |row: &&usize| within.iter().all(|(values, low, high)| (*low..=*high).contains(&values[**row]));
        let chosen: Vec<usize> = rows.iter().filter(is_within).copied().collect();
        let mut shares = vec![0; campaign.runs.len()];
        chosen.iter().for_each(|row| shares[run_of(*row)] += 1);
        let mut runs: Vec<Share> = campaign
            .runs
            .iter()
            .zip(shares)
            .filter(|(_, samples)| *samples > 0)
            .map(|(run, samples)| Share { run: run.name.clone(), samples })
            .collect();
        runs.sort_by_key(|share| std::cmp::Reverse(share.samples));
        let models = residuals_ug.iter().map(|residuals| Figures::of(residuals, &chosen)).collect();
        Chosen { samples: chosen.len(), of: rows.len(), models, runs }
    }

    /// The values that a range is about and its ends; nothing for a column that there isn't.
    fn limits<'a>(&'a self, range: &Range, residuals_ug: &[&'a [f32]]) -> Option<(&'a [f32], f32, f32)> {
        let values = if range.column == RESIDUAL {
            residuals_ug.first().copied()?
        } else {
            self.values[COLUMNS.iter().position(|name| *name == range.column)?].as_slice()
        };
        Some((values, range.low.unwrap_or(f32::NEG_INFINITY), range.high.unwrap_or(f32::INFINITY)))
    }
}

impl Figures {
    fn of(residuals_ug: &[f32], rows: &[usize]) -> Self {
        let values = || rows.iter().map(|row| f64::from(residuals_ug[*row]));
        let count = rows.len().max(1) as f64;
        Self {
            rms_ug: (values().map(|ug| ug * ug).sum::<f64>() / count).sqrt(),
            mean_ug: values().sum::<f64>() / count,
        }
    }
}

const HOUR_US: f64 = 3.6e9;

fn places(residuals: &Residuals) -> Vec<Place> {
    let mut next = Place { from_h: 0.0, to_h: 0.0, first: 0 };
    let mut place = |run: &crate::residuals::RunResiduals| {
        let mine = Place { to_h: next.from_h + run.run.duration_s() / 3600.0, ..next };
        next = Place { from_h: mine.to_h, to_h: mine.to_h, first: mine.first + run.run.rows.len() };
        mine
    };
    residuals.runs.iter().map(&mut place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{Quantity, Row, Run};
    use crate::residuals::RunResiduals;
    use protocol::Sample;
    use std::path::PathBuf;

    /// Two runs of so many samples, a minute apart, whose temperature rises by one degree a sample.
    fn campaign(rows: usize) -> Campaign {
        let row = |k: usize| {
            let (time_us, temperature_uc) = (k as u64 * 60_000_000, (k as i32).saturating_mul(1_000_000));
            Row {
                sample: Sample::from_difference(time_us, 0, temperature_uc),
                reference_g: 0.0,
                reference_sigma_g: None,
            }
        };
        let run = |name: &str| Run {
            name: name.to_owned(),
            kind: String::new(),
            source: PathBuf::new(),
            rows: (0..rows).map(row).collect(),
        };
        Campaign::new(vec![run("one"), run("two")], Vec::new(), Quantity::default())
    }

    fn columns(campaign: &Campaign) -> Columns {
        let of = |run| RunResiduals { run, readings: Vec::new(), residuals_g: vec![0.0; run.rows.len()] };
        Columns::of(&Residuals { runs: campaign.runs.iter().map(of).collect() })
    }

    #[test]
    fn runs_lie_end_to_end_and_columns_have_their_units() {
        let campaign = campaign(61);
        let columns = columns(&campaign);
        assert_eq!(columns.len(), 122);
        let at = |name: &str, row: usize| columns.values[COLUMNS.iter().position(|one| *one == name).expect(name)][row];
        assert_eq!((at("run", 60), at("run", 61)), (0.0, 1.0));
        assert_eq!((at("time_h", 60), at("time_h", 61), at("time_h", 121)), (1.0, 1.0, 2.0));
        assert_eq!((at("temperature_c", 30), at("rate_c_per_min", 30)), (30.0, 1.0));
        assert!(at("age_days", 0).is_nan());
    }

    #[test]
    fn of_many_samples_every_extreme_of_every_model_is_drawn() {
        let campaign = campaign(50_000);
        let columns = columns(&campaign);
        let mut models = [vec![0.0_f32; 100_000], vec![0.0_f32; 100_000]];
        for (row, (model, value)) in [(7, (0, 9.0)), (49_999, (0, -9.0)), (50_000, (1, 8.0)), (99_998, (1, -8.0))] {
            models[model][row] = value;
        }
        let models: Vec<&[f32]> = models.iter().map(Vec::as_slice).collect();
        let (kept, stride) = columns.drawn(&models, 10_000);
        assert!(kept.len() <= 10_004 && stride == 40 && kept.is_sorted(), "{} {stride}", kept.len());
        for row in [7, 49_999, 50_000, 99_998] {
            assert!(kept.binary_search(&row).is_ok(), "{row}");
        }
        assert_eq!(columns.drawn(&models, 100_000), ((0..100_000).collect(), 1));
    }

    #[test]
    fn a_choice_is_counted_over_all_samples() {
        let campaign = campaign(61);
        let columns = columns(&campaign);
        let residuals: Vec<f32> = (0..122).map(|row| if row % 2 == 0 { 3.0 } else { -4.0 }).collect();
        let range = |column: &str, low, high| Range { column: column.to_owned(), low, high };
        let ranges = [range("temperature_c", Some(9.5), Some(19.5)), range(RESIDUAL, None, Some(0.0))];
        let chosen = columns.chosen(&campaign, &[&residuals], &ranges, |_| true);
        assert_eq!((chosen.samples, chosen.of), (10, 122));
        assert_eq!(chosen.models, [Figures { rms_ug: 4.0, mean_ug: -4.0 }]);
        assert_eq!(chosen.runs.iter().map(|share| share.samples).sum::<usize>(), 10);
        let second = columns.chosen(&campaign, &[&residuals], &[], |name| name == "two");
        assert_eq!((second.samples, second.runs[0].run.as_str()), (61, "two"));
        assert_eq!(columns.chosen(&campaign, &[&residuals], &[range("time_h", Some(5.0), None)], |_| true).samples, 0);
    }
}
