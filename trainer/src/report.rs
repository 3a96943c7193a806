//! A model's quality as data: the answer, figures before and after, charts, and where everything came from.
//! Numbers only; whoever shows them decides how.

mod chart;
mod residual_charts;
mod samples;
mod thin;

pub use chart::{Axis, AxisName, Chart, Layer, Scale, Tone};
pub use samples::{RunName, Sample, samples};

use crate::campaign::Campaign;
use crate::compare::{Comparison, compare, unseen};
use crate::model::Model;
use crate::residuals::{ResidualError, arranged, residuals};
use serde::Serialize;

/// Everything that a report shows.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Figures as `compare` gives them.
    pub comparison: Comparison,
    /// The runs, as dots of the charts refer to them.
    pub runs: Vec<RunName>,
    /// The charts.
    pub charts: Vec<Chart>,
}

/// A report on a model from a campaign.
///
/// # Errors
/// [`ResidualError`] says which model or row is at fault.
pub fn report(model: &Model, campaign: &Campaign) -> Result<Report, ResidualError> {
    let comparison = compare(model, campaign)?;
    let campaign = arranged(model, campaign)?;
    let residuals = residuals(model, &campaign.runs)?;
    let held_out = |run: &crate::campaign::Run| unseen(model, &campaign, run);
    let runs: Vec<RunName> = campaign.runs.iter().map(|run| RunName::of(run, held_out(run))).collect();
    let samples = samples(&residuals);
    let charts = residual_charts::residual_charts(&runs, &samples);
    Ok(Report { comparison, runs, charts })
}
