//! What every method starts from, and how a method's best becomes a model.

use super::baseline::Baseline;
use super::error::TrainError;
use super::search::Candidate;
use super::settings::TrainSettings;
use crate::campaign::{Campaign, Run, Split};
use crate::effect_choice::choose;
use crate::fit::dataset::{Datum, InputScale};
use crate::fit::effects::Chosen;
use crate::fit::neighbours::merged;
use crate::fit::polynomial::{MOST_T, Polynomial};
use crate::model::{Model, ModelDomain, ModelEffect, ModelNetwork, ModelScaling, Provenance, Units};
use crate::noise::{Components, Mean, sample_sigma_g};
use crate::progress::Progress;
use crate::yardstick::Yardstick;
use firmware_core::effect::Parameter;
use protocol::Weights;

/// What every method starts from.
pub(super) struct Task<'a> {
    pub runs: Vec<&'a Run>,
    pub effects: Vec<Chosen>,
    pub max_gap_us: u32,
    pub data: Vec<Datum>,
    pub scale: InputScale,
    pub polynomial: Polynomial,
    /// Noise of one sample, g.
    pub sigma_g: f64,
    pub settings: &'a TrainSettings,
    /// The way back to the campaign's units.
    pub yardstick: Yardstick,
    pub progress: &'a dyn Progress,
}

impl<'a> Task<'a> {
    /// In the units of `yardstick`, as `campaign` and `settings` are.
    pub fn new(
        campaign: &'a Campaign,
        split: &Split,
        settings: &'a TrainSettings,
        yardstick: Yardstick,
        progress: &'a dyn Progress,
    ) -> Result<Self, TrainError> {
        settings.check()?;
        let runs: Vec<(usize, &Run)> =
            split.training.iter().filter_map(|&index| Some((index, campaign.runs.get(index)?))).collect();
        let scale = InputScale::of(runs.iter().map(|(_, run)| *run)).ok_or(TrainError::NoTrainingRuns)?;
        let mut references = runs.iter().flat_map(|(_, run)| &run.rows).map(|row| row.reference_g);
        let first_g = references.next();
        if settings.scale_factor_hz_per_g.is_none() && references.all(|reference_g| Some(reference_g) == first_g) {
            return Err(TrainError::NoScaleFactor);
        }
        let data = merged(runs.iter().copied(), &scale);
        let polynomial = match settings.scale_factor_hz_per_g {
            Some(stated) => Polynomial::fit_still(&data, scale.delta_f_half_span_hz / stated, MOST_T),
            None => Polynomial::fit(&data),
        };
        let baseline = Baseline { polynomial, scale };
        let residuals: Vec<_> = runs.iter().map(|(_, run)| (*run, baseline.residuals_g(run))).collect();
        let sigma_g = sample_sigma_g(residuals.iter().map(|(run, residuals)| (*run, residuals)));
        let Baseline { polynomial, scale } = baseline;
        let runs: Vec<&Run> = runs.into_iter().map(|(_, run)| run).collect();
        Ok(Self {
            effects: settings.effects.iter().map(|choice| choose(choice, campaign, &runs)).collect::<Result<_, _>>()?,
            max_gap_us: campaign.max_gap_us(),
            runs,
            data,
            scale,
            polynomial,
            sigma_g: sigma_g.unwrap_or(0.0).max(LEAST_SIGMA_G),
            settings,
            yardstick,
            progress,
        })
    }

    /// Sources of scatter in the residuals of a fit of the training data.
    pub fn noise(&self, fit_g: impl Fn(&Datum) -> f64) -> Components {
        let mean = |datum: &Datum| Mean {
            run: datum.run,
            samples: datum.weight,
            residual_g: fit_g(datum) - datum.reference_g,
        };
        Components::estimate(self.sigma_g, &self.data.iter().map(mean).collect::<Vec<_>>())
    }

    /// The model of `campaign`, in its own units.
    pub fn model(&self, campaign: &Campaign, split: &Split, best: &Candidate) -> Model {
        let Weights { mut input, bias, mut output, mut output_bias } = best.weights;
        let [constant, by_x, by_t, by_xt] = best.line_g;
        let turn = if self.yardstick.is_turned() { -1.0 } else { 1.0 };
        input.iter_mut().for_each(|[x, _]| *x *= turn as f32);
        let line_g = [constant, turn * by_x, by_t, turn * by_xt].map(|value| (value / self.yardstick.factor()) as f32);
        // What is negative is the network, not its unit.
        let negate = self.yardstick.factor().signum() as f32;
        output.iter_mut().chain([&mut output_bias]).for_each(|weight| *weight *= negate);
        let zero_uhz = self.scale.delta_f_zero_uhz;
        let effect = |(chosen, values): (&Chosen, &Vec<f64>)| {
            fitted(chosen, &self.yardstick.coefficients_outside(chosen.about, values), campaign)
        };
        Model {
            format: Model::FORMAT,
            serial: self.settings.serial.clone(),
            provenance: self.provenance(campaign, split),
            units: Units {
                signal: campaign.quantity.signal_unit.clone(),
                reference: campaign.quantity.reference_unit.clone(),
            },
            scaling: ModelScaling {
                delta_f_zero_uhz: if self.yardstick.is_turned() { zero_uhz.saturating_neg() } else { zero_uhz },
                delta_f_gain_per_hz: self.scale.delta_f_half_span_hz.recip() as f32,
                temperature_zero_uc: self.scale.temperature_zero_uc,
                temperature_gain_per_c: self.scale.temperature_half_span_c.recip() as f32,
                line_g,
                output_g: self.yardstick.outside(best.output_g) as f32,
            },
            domain: self.domain(),
            network: ModelNetwork { input, bias, output, output_bias },
            channels: self.channels(campaign),
            effects: self.effects.iter().zip(&best.coefficients.values).map(effect).collect(),
        }
    }

    /// The auxiliary channels that the effects follow, each once.
    fn channels(&self, campaign: &Campaign) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for effect in &self.effects {
            for (channel, name) in campaign.channels.iter().enumerate() {
                if effect.follows(channel) && !names.contains(name) {
                    names.push(name.clone());
                }
            }
        }
        names
    }

    fn provenance(&self, campaign: &Campaign, split: &Split) -> Provenance {
        let names = |indices: &[usize]| {
            indices.iter().filter_map(|&index| campaign.runs.get(index)).map(|run| run.name.clone()).collect()
        };
        Provenance {
            made_by: concat!("tempco ", env!("CARGO_PKG_VERSION")).to_owned(),
            campaign: campaign.hash(),
            method: self.settings.method.name().to_owned(),
            seed: self.settings.seed,
            restarts: self.settings.restarts,
            training_runs: names(&split.training),
            held_out_runs: names(&split.held_out),
            training_residual: 0.0,
            scale_factor_hz_per_g: None,
            read_as: campaign.read_as.clone(),
        }
    }

    /// The training data's rectangle and a little more, so that noise at its edge raises no flag.
    fn domain(&self) -> ModelDomain {
        let half_f_uhz = (self.scale.delta_f_half_span_hz * 1e6 * (1.0 + DOMAIN_MARGIN)).ceil() as i64;
        let half_t_uc = (self.scale.temperature_half_span_c * 1e6 * (1.0 + DOMAIN_MARGIN)).ceil() as i32;
        let (f, t) = (self.scale.delta_f_zero_uhz, self.scale.temperature_zero_uc);
        let f = if self.yardstick.is_turned() { f.saturating_neg() } else { f };
        ModelDomain {
            delta_f_uhz: [f.saturating_sub(half_f_uhz), f.saturating_add(half_f_uhz)],
            temperature_uc: [t.saturating_sub(half_t_uc), t.saturating_add(half_t_uc)],
            max_gap_us: self.max_gap_us,
        }
    }
}

/// A fitted effect as the model file keeps it.
fn fitted(effect: &Chosen, values: &[f64], campaign: &Campaign) -> ModelEffect {
    let idle = |parameter: &Parameter| effect.expression.as_ref().is_some_and(|text| text.leaves_idle(parameter));
    let named = effect.about.parameters.iter().zip(values).filter(|(parameter, _)| !idle(parameter));
    ModelEffect {
        name: effect.about.name.to_owned(),
        channel: effect.about.channel.and_then(|_| campaign.channels.get(effect.channel).cloned()),
        expression: effect.expression.as_ref().map(|expression| expression.text().to_owned()),
        parameters: named.map(|(parameter, value)| (parameter.name.to_owned(), *value)).collect(),
    }
}

/// Share of the half span by which the calibrated domain exceeds the training data.
const DOMAIN_MARGIN: f64 = 0.02;
/// Noise is never taken to be less than this, so that noiseless data give no division by zero, g.
const LEAST_SIGMA_G: f64 = 1e-9;
