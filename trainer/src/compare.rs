//! Model against measurements.

#[cfg(test)]
mod tests;

use crate::campaign::{Campaign, Run};
use crate::metrics::allan::{AllanPoint, allan};
use crate::metrics::full_temperature::{FullTemperature, full_temperature};
use crate::metrics::stability::{Stability, stability};
use crate::metrics::zero_bias::{ZeroBias, zero_bias};
use crate::model::Model;
use crate::noise::{rms, sample_sigma_g};
use crate::residuals::{ResidualError, Residuals, RunResiduals, arranged, residuals};
use crate::sensitivity::{Sensitivity, sensitivity};
use crate::warnings::warnings;
use serde::Serialize;

/// How well a model reads a campaign.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// RMS residual on the held-out runs (on all runs where none is held out), µg.
    pub residual_ug: f64,
    /// Noise that no model could remove, from differences of neighbouring samples, µg.
    pub noise_floor_ug: Option<f64>,
    /// Whether `residual_ug` is of runs that the training never saw.
    pub held_out: bool,
    /// Local slope against the measured scale factor, ppm.
    pub sensitivity_ppm: Option<Sensitivity>,
    /// What the reader should know before believing the figures.
    pub warnings: Vec<String>,
    /// Run by run.
    pub runs: Vec<RunComparison>,
    /// Figures of merit, raw and compensated, run by run.
    pub figures: Vec<RunFigures>,
}

/// One run's residual.
#[derive(Clone, Debug, Serialize)]
pub struct RunComparison {
    /// The run.
    pub run: String,
    /// What it was.
    pub kind: String,
    /// Its rows.
    pub samples: usize,
    /// Whether the training never saw it.
    pub held_out: bool,
    /// RMS residual, µg.
    pub residual_ug: f64,
    /// Mean residual, µg: the run's own offset.
    pub mean_ug: f64,
    /// RMS about that mean, µg.
    pub about_mean_ug: f64,
    /// Readings flagged as outside the calibrated domain, stale or faulty.
    pub flagged: usize,
}

/// One run's figures of merit.
#[derive(Clone, Debug, Serialize)]
pub struct RunFigures {
    /// The run.
    pub run: String,
    /// Whether the training never saw it.
    pub held_out: bool,
    /// Of the raw frequency difference over the mean scale factor.
    pub raw: Figures,
    /// Of the compensated reading.
    pub compensated: Figures,
}

/// Figures of merit, where the run allows them.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    /// Of runs of kind `zero`.
    pub zero_bias: Option<ZeroBias>,
    /// Of runs with ±1 g and 0 g at several temperatures.
    pub full_temperature: Option<FullTemperature>,
    /// Of evenly sampled runs of kind `zero` or `static`.
    pub allan: Option<Vec<AllanPoint>>,
    /// Of the same runs, every definition of stability at rest.
    pub stability: Option<Stability>,
}

/// Compares the model with every run of the campaign. Which runs were held out is read from the model.
///
/// # Errors
/// [`ResidualError`] says which model or row is at fault.
pub fn compare(model: &Model, campaign: &Campaign) -> Result<Comparison, ResidualError> {
    let campaign = arranged(model, campaign)?;
    let residuals = residuals(model, &campaign.runs)?;
    let unseen = |run: &Run| unseen(model, &campaign, run);
    let any_held_out = campaign.runs.iter().any(unseen);
    let counted = residuals.runs.iter().filter(|run| !any_held_out || unseen(run.run));
    let residual_g = rms(counted.flat_map(|run| &run.residuals_g));
    let sensitivity = sensitivity(model, &campaign);
    Ok(Comparison {
        residual_ug: residual_g * 1e6,
        noise_floor_ug: noise_floor_g(&residuals).map(|floor| floor * 1e6),
        held_out: any_held_out,
        warnings: warnings(&campaign, &residuals, sensitivity.as_ref()),
        sensitivity_ppm: sensitivity,
        runs: residuals.runs.iter().map(|run| run_comparison(run, unseen(run.run))).collect(),
        figures: residuals.runs.iter().filter_map(|run| run_figures(model, run, unseen(run.run))).collect(),
    })
}

/// Whether the training never saw a run. Another campaign's runs may bear the same names; none of them was seen.
#[must_use]
pub fn unseen(model: &Model, campaign: &Campaign, run: &Run) -> bool {
    !(model.provenance.training_runs.contains(&run.name) && model.provenance.campaign == campaign.hash())
}

/// Noise from one sample to the next over all runs, g.
#[must_use]
pub fn noise_floor_g(residuals: &Residuals) -> Option<f64> {
    sample_sigma_g(residuals.runs.iter().map(|run| (run.run, &run.residuals_g)))
}

fn run_comparison(run: &RunResiduals, held_out: bool) -> RunComparison {
    let mean_g = crate::metrics::mean(&run.residuals_g);
    let rms_g = run.rms_g();
    RunComparison {
        run: run.run.name.clone(),
        kind: run.run.kind.clone(),
        samples: run.run.rows.len(),
        held_out,
        residual_ug: rms_g * 1e6,
        mean_ug: mean_g * 1e6,
        about_mean_ug: (rms_g * rms_g - mean_g * mean_g).max(0.0).sqrt() * 1e6,
        flagged: run.flagged(),
    }
}

fn run_figures(model: &Model, run: &RunResiduals, held_out: bool) -> Option<RunFigures> {
    let signal_hz: Vec<f64> = run.run.rows.iter().map(|row| row.sample.delta_f_uhz as f64 * 1e-6).collect();
    let readings_g: Vec<f64> = run.readings.iter().map(|reading| f64::from(reading.acceleration_g)).collect();
    let g_per_hz = mean_slope_g_per_hz(model);
    let raw_g: Vec<f64> = signal_hz.iter().map(|hz| hz * g_per_hz).collect();
    let raw_residuals_g: Vec<f64> =
        raw_g.iter().zip(&run.run.rows).map(|(raw_g, row)| raw_g - row.reference_g).collect();
    let raw = figures(run.run, &raw_g, &raw_residuals_g, &signal_hz);
    let compensated = figures(run.run, &readings_g, &run.residuals_g, &readings_g);
    let any = compensated.zero_bias.is_some() || compensated.full_temperature.is_some() || compensated.allan.is_some();
    any.then(|| RunFigures { run: run.run.name.clone(), held_out, raw, compensated })
}

/// The slope of the model in the middle of its domain: what a raw figure in Hz is divided by.
#[must_use]
pub fn mean_slope_g_per_hz(model: &Model) -> f64 {
    model.slope().in_the_middle()
}

fn figures(run: &Run, outputs_g: &[f64], residuals_g: &[f64], outputs: &[f64]) -> Figures {
    let still = run.kind == "zero" || run.kind == "static";
    let allan = still.then(|| allan(run, residuals_g)).flatten();
    Figures {
        zero_bias: zero_bias(run, outputs_g),
        full_temperature: full_temperature(run, outputs),
        stability: still.then(|| stability(run, residuals_g, allan.as_deref())),
        allan,
    }
}
