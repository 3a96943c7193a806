//! The instrument before compensation: a straight line through its frequency difference.

use crate::campaign::{Campaign, Run};
use crate::compare::{mean_slope_g_per_hz, unseen};
use crate::metrics::levels::{level_width, span};
use crate::metrics::mean;
use crate::model::Model;
use crate::noise::rms;

/// a = slope·Δf + constant, as one would calibrate without a thermometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawLine {
    slope_g_per_hz: f64,
    constant_g: f64,
}

impl RawLine {
    /// Least squares on the training runs, or on all where the training saw none of them. Where the reference never
    /// varies, the slope is the model's.
    #[must_use]
    pub fn fit(model: &Model, campaign: &Campaign) -> Self {
        let seen: Vec<&Run> = campaign.runs.iter().filter(|run| !unseen(model, campaign, run)).collect();
        let runs = if seen.is_empty() { campaign.runs.iter().collect() } else { seen };
        let points: Vec<[f64; 2]> =
            runs.iter().flat_map(|run| &run.rows).map(|row| [hz(row), row.reference_g]).collect();
        let centre = |axis: usize| mean(&points.iter().map(|point| point[axis]).collect::<Vec<_>>());
        let (hz_mean, g_mean) = (centre(0), centre(1));
        let sum = |a: usize, b: usize| {
            let means = [hz_mean, g_mean];
            points.iter().map(|point| (point[a] - means[a]) * (point[b] - means[b])).sum::<f64>()
        };
        let references: Vec<f64> = points.iter().map(|point| point[1]).collect();
        let varies = span(&references) > level_width(&references);
        let slope_g_per_hz = if varies { sum(0, 1) / sum(0, 0) } else { mean_slope_g_per_hz(model) };
        Self { slope_g_per_hz, constant_g: g_mean - slope_g_per_hz * hz_mean }
    }

    /// Reading minus reference of each row, g.
    #[must_use]
    pub fn residuals_g(&self, run: &Run) -> Vec<f64> {
        run.rows.iter().map(|row| self.slope_g_per_hz * hz(row) + self.constant_g - row.reference_g).collect()
    }

    /// RMS over runs, g.
    #[must_use]
    pub fn rms_g<'a>(&self, runs: impl IntoIterator<Item = &'a Run>) -> f64 {
        let residuals: Vec<f64> = runs.into_iter().flat_map(|run| self.residuals_g(run)).collect();
        rms(&residuals)
    }
}

fn hz(row: &crate::campaign::Row) -> f64 {
    row.sample.delta_f_uhz as f64 * 1e-6
}
