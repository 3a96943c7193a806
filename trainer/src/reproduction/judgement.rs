//! One column of the tables: its figures of merit, and what they do not show.

use super::evolution::Quartiles;
use super::paper::{ROWS, TEST_RUNS};
use super::sweep::Sweep;
use super::trial::Share;
use super::truth::Truth;
use crate::campaign::{Campaign, Run};
use crate::compare::{Figures, RunFigures, compare};
use crate::metrics::full_temperature::full_temperature;
use crate::metrics::zero_bias::zero_bias;
use crate::noise::rms;
use crate::residuals::{ResidualError, arranged, residuals};
use crate::train::Trained;

/// How well one method does on the test runs.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// The method.
    pub name: String,
    /// The paper's figures of merit in the order of [`ROWS`]; `None` where the campaign has no such run.
    pub cells: [Option<f64>; ROWS.len()],
    /// RMS residual on the test runs, constants included, µg.
    pub residual_ug: f64,
    /// Between the levels.
    pub sweep: Sweep,
    /// RMS residual on the training runs, restart by restart, µg; none of what isn't trained from random starts.
    pub restarts_ug: Vec<f64>,
}

impl Judgement {
    /// Cells in which it is no worse than the paper's IFA-BP.
    #[must_use]
    pub fn as_good_as_the_paper(&self) -> Share {
        let good = self.cells.iter().zip(&ROWS).filter(|(cell, row)| cell.is_some_and(|cell| cell <= row.ifa_bp));
        Share { hits: good.count(), of: ROWS.len() }
    }

    /// Quartiles of the residual on the training runs over the restarts, µg.
    #[must_use]
    pub fn restart_quartiles_ug(&self) -> Option<Quartiles> {
        Quartiles::of(self.restarts_ug.clone())
    }

    /// Pairs of restarts of which this method's ends with the lower residual.
    #[must_use]
    pub fn trains_better_than(&self, other: &Self) -> Share {
        let pairs = || self.restarts_ug.iter().flat_map(|mine| other.restarts_ug.iter().map(move |its| (mine, its)));
        Share { hits: pairs().filter(|(mine, its)| mine < its).count(), of: pairs().count() }
    }

    /// A trained model, in the device's own arithmetic.
    ///
    /// # Errors
    /// [`ResidualError`] says which model or row is at fault.
    pub fn trained(
        name: &str,
        trained: &Trained,
        campaign: &Campaign,
        truth: &dyn Truth,
    ) -> Result<Self, ResidualError> {
        let model = &trained.model;
        let campaign = &arranged(model, campaign)?;
        let figures = compare(model, campaign)?.figures;
        let of = |run: &Run| Ok(residuals(model, [run])?.runs.remove(0).residuals_g);
        Ok(Self {
            name: name.to_owned(),
            cells: cells(&figures, |figures| &figures.compensated),
            residual_ug: on_test_runs_ug(campaign, of)?,
            sweep: sweep(truth, of)?,
            restarts_ug: trained.restarts.iter().map(|restart| restart.residual_g * 1e6).collect(),
        })
    }

    /// No compensation: the frequency difference over the mean scale factor. `trained` is any model whose slope is
    /// that of the sensor.
    ///
    /// # Errors
    /// [`ResidualError`] says which model or row is at fault.
    pub fn raw(trained: &Trained, campaign: &Campaign, truth: &dyn Truth) -> Result<Self, ResidualError> {
        let figures = compare(&trained.model, campaign)?.figures;
        let of = |run: &Run| Ok(trained.raw_g(run));
        Ok(Self {
            name: "raw".to_owned(),
            cells: cells(&figures, |figures| &figures.raw),
            residual_ug: on_test_runs_ug(campaign, of)?,
            sweep: sweep(truth, of)?,
            restarts_ug: Vec::new(),
        })
    }

    /// The polynomial Δf² · T³.
    ///
    /// # Errors
    /// None; the type is that of the others.
    pub fn polynomial(trained: &Trained, campaign: &Campaign, truth: &dyn Truth) -> Result<Self, ResidualError> {
        Self::computed("polynomial", campaign, truth, |run| trained.baseline.residuals_g(run))
    }

    /// The perfect static compensation. What reads less noise than this from frequency difference and temperature has
    /// learnt the levels by heart.
    ///
    /// # Errors
    /// None; the type is that of the others.
    pub fn perfect(campaign: &Campaign, truth: &dyn Truth) -> Result<Self, ResidualError> {
        let residual_g = |row: &crate::campaign::Row| {
            let (hz, celsius) = (row.sample.delta_f_uhz as f64 * 1e-6, f64::from(row.sample.temperature_uc) * 1e-6);
            truth.acceleration_g(hz, celsius) - row.reference_g
        };
        Self::computed("perfect map", campaign, truth, |run| run.rows.iter().map(residual_g).collect())
    }

    fn computed(
        name: &str,
        campaign: &Campaign,
        truth: &dyn Truth,
        residuals_g: impl Fn(&Run) -> Vec<f64>,
    ) -> Result<Self, ResidualError> {
        let of = |run: &Run| Ok(residuals_g(run));
        let readings_g = |run: &Run| -> Vec<f64> {
            residuals_g(run).iter().zip(&run.rows).map(|(residual, row)| residual + row.reference_g).collect()
        };
        let cell = |index: usize| {
            let run = campaign.runs.iter().find(|run| run.name == ROWS[index].run())?;
            let readings_g = readings_g(run);
            let full_temperature = full_temperature(run, &readings_g);
            ROWS[index].figure.of(zero_bias(run, &readings_g).as_ref(), full_temperature.as_ref())
        };
        Ok(Self {
            name: name.to_owned(),
            cells: std::array::from_fn(cell),
            residual_ug: on_test_runs_ug(campaign, of)?,
            sweep: sweep(truth, of)?,
            restarts_ug: Vec::new(),
        })
    }
}

fn cells(figures: &[RunFigures], which: fn(&RunFigures) -> &Figures) -> [Option<f64>; ROWS.len()] {
    std::array::from_fn(|index| {
        let run = figures.iter().find(|figures| figures.run == ROWS[index].run())?;
        let Figures { zero_bias, full_temperature, .. } = which(run);
        ROWS[index].figure.of(zero_bias.as_ref(), full_temperature.as_ref())
    })
}

fn on_test_runs_ug(
    campaign: &Campaign,
    residuals_g: impl Fn(&Run) -> Result<Vec<f64>, ResidualError>,
) -> Result<f64, ResidualError> {
    let tested = campaign.runs.iter().filter(|run| TEST_RUNS.contains(&run.name.as_str()));
    let residuals = tested.map(residuals_g).collect::<Result<Vec<_>, _>>()?;
    Ok(rms(residuals.iter().flatten()) * 1e6)
}

fn sweep(
    truth: &dyn Truth,
    residuals_g: impl Fn(&Run) -> Result<Vec<f64>, ResidualError>,
) -> Result<Sweep, ResidualError> {
    Sweep::of(truth, |run| Ok(residuals_g(run)?.first().copied().unwrap_or(f64::NAN)))
}
