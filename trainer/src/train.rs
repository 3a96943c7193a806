//! From training runs to a model.

mod backprop;
mod second_order;

pub use backprop::{Backprop, Swarm};

use crate::campaign::{Campaign, Run, Split};
use crate::fit::dataset::{Datum, InputScale, merged};
use crate::fit::effects::{Chosen, Coefficients};
use crate::fit::firefly::FireflyError;
use crate::fit::gradient_descent::DescentError;
use crate::fit::polynomial::Polynomial;
use crate::model::{Model, ModelDomain, ModelEffect, ModelNetwork, ModelScaling, Provenance, Units};
use crate::noise::{Components, Mean, sample_sigma_g};
use crate::progress::Progress;
use crate::residuals::{Residuals, residuals};
use firmware_core::effect;
use protocol::Weights;
use thiserror::Error;

/// How the weights are found.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// Variable projection and Levenberg–Marquardt from random starts, with the slope held to the
    /// measured scale factor.
    SecondOrder,
    /// The paper's: gradient descent from the best of a firefly swarm.
    Backprop(Backprop),
}

impl Method {
    /// Its name on the command line and in model files.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::SecondOrder => "second-order",
            Self::Backprop(Backprop { swarm: Swarm::Standard(_), .. }) => "fa-bp",
            Self::Backprop(Backprop { swarm: Swarm::Improved(_), .. }) => "ifa-bp",
        }
    }
}

/// What to train.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainSettings {
    /// How.
    pub method: Method,
    /// Trainings from different starts; the one with the least cost is kept.
    pub restarts: usize,
    /// Seed of every random number.
    pub seed: u64,
    /// Scale factor, Hz/g, for a campaign whose reference never varies.
    pub scale_factor_hz_per_g: Option<f64>,
    /// Serial number of the sensor; empty fits any.
    pub serial: String,
    /// Physical effects beside the network; second-order method only.
    pub effects: Vec<EffectChoice>,
    /// What keeps the network smooth between the measurements; second-order method only.
    pub anchoring: Anchoring,
}

/// What keeps the network smooth where the measurements leave it open.
/// `docs/decisions/0003-anchors.md` compares them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchoring {
    /// Nothing but the priors of the weights.
    Nothing,
    /// Slopes: the scale factor that the campaign measured.
    Slopes,
    /// Values of the smooth instrument.
    Values,
    /// Both; the default.
    Both,
}

/// A physical effect to fit.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectChoice {
    /// Its name.
    pub name: String,
    /// The campaign's channel that it follows, where not the effect's usual one.
    pub channel: Option<String>,
    /// Coefficients to start from, in the effect's order; `None` searches.
    pub start: Option<Vec<f64>>,
}

impl EffectChoice {
    /// The effect of this name, searched from scratch.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self { name: name.to_owned(), channel: None, start: None }
    }

    /// The effects of a model, to be fitted anew from where they are.
    #[must_use]
    pub fn of(model: &Model) -> Vec<Self> {
        let start = |effect: &ModelEffect| {
            let about = effect::about(&effect.name)?;
            about.parameters.iter().map(|parameter| effect.parameters.get(parameter.name).copied()).collect()
        };
        let choice = |effect: &ModelEffect| Self {
            name: effect.name.clone(),
            channel: effect.channel.clone(),
            start: start(effect),
        };
        model.effects.iter().map(choice).collect()
    }
}

impl TrainSettings {
    /// The default method with 30 restarts, as many as the paper makes.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self {
            method: Method::SecondOrder,
            restarts: 30,
            seed,
            scale_factor_hz_per_g: None,
            serial: String::new(),
            effects: Vec::new(),
            anchoring: Anchoring::Both,
        }
    }
}

/// A model and how it came about.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The best restart's model.
    pub model: Model,
    /// Every restart in order.
    pub restarts: Vec<Restart>,
    /// The polynomial baseline of the same training runs.
    pub baseline: Baseline,
    raw: Baseline,
}

impl Trained {
    /// Residuals without any compensation: a line through reference and frequency difference, g.
    #[must_use]
    pub fn raw_g(&self, run: &Run) -> Vec<f64> {
        self.raw.residuals_g(run)
    }
}

/// The polynomial in Δf and T with its input scale.
#[derive(Clone, Debug)]
pub struct Baseline {
    /// The polynomial in scaled inputs.
    pub polynomial: Polynomial,
    /// The scale.
    pub scale: InputScale,
}

impl Baseline {
    /// Residuals of the polynomial on a run, g.
    #[must_use]
    pub fn residuals_g(&self, run: &Run) -> Vec<f64> {
        let residual = |row: &crate::campaign::Row| {
            let [x, t] = self.scale.inputs(&row.sample);
            self.polynomial.evaluate(x, t) - row.reference_g
        };
        run.rows.iter().map(residual).collect()
    }
}

/// One training from one start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// RMS residual on the training data, g.
    pub residual_g: f64,
    /// Iterations made.
    pub iterations: usize,
    /// Whether it ended because nothing was left to gain, and not at a limit.
    pub converged: bool,
}

/// Why there is no model.
#[derive(Debug, Error)]
pub enum TrainError {
    /// Nothing to learn from.
    #[error("no training runs are left after holding out; name fewer runs with --hold-out")]
    NoTrainingRuns,
    /// The restart count is zero.
    #[error("at least one restart is needed")]
    NoRestarts,
    /// Stopped before the first restart ended.
    #[error("cancelled before the first restart ended")]
    Cancelled,
    /// No effect has this name.
    #[error("there is no effect named `{0}`; `tempco effects` lists them")]
    UnknownEffect(String),
    /// The campaign lacks the effect's channel.
    #[error("effect `{effect}` follows the channel `{channel}`, which the campaign doesn't have")]
    NoChannel {
        /// The effect.
        effect: String,
        /// Its channel.
        channel: String,
    },
    /// The paper's methods train a network alone.
    #[error("effects can be fitted with the second-order method only")]
    EffectsNeedSecondOrder,
    /// A setting of the firefly swarm makes no sense.
    #[error("firefly swarm: {0}")]
    Swarm(#[from] FireflyError),
    /// A setting of the gradient descent makes no sense.
    #[error("gradient descent: {0}")]
    Descent(#[from] DescentError),
    /// No restart gave finite weights.
    #[error("no restart converged to finite weights; look at the campaign with `tempco inspect`")]
    NoFiniteWeights,
}

/// What every method starts from.
struct Task<'a> {
    runs: Vec<&'a Run>,
    effects: Vec<Chosen>,
    max_gap_us: u32,
    data: Vec<Datum>,
    scale: InputScale,
    polynomial: Polynomial,
    /// Noise of one sample, g.
    sigma_g: f64,
    settings: &'a TrainSettings,
    progress: &'a dyn Progress,
}

/// What a restart of any method ends with.
struct Candidate {
    restart: Restart,
    cost: f64,
    line_g: [f64; 4],
    output_g: f64,
    weights: Weights,
    coefficients: Coefficients,
}

/// What a method found.
struct Search {
    restarts: Vec<Restart>,
    best: Option<Candidate>,
}

impl Search {
    /// The restart of least cost; the first of equals, so that the number of threads doesn't matter.
    fn of(candidates: Vec<Candidate>) -> Self {
        let restarts = candidates.iter().map(|candidate| candidate.restart).collect();
        Self { restarts, best: candidates.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost)) }
    }
}

/// Trains on the split's training runs.
///
/// Same campaign, same settings: same model, byte for byte, on any number of threads.
///
/// # Errors
/// [`TrainError`] says what is missing.
pub fn train(
    campaign: &Campaign,
    split: &Split,
    settings: &TrainSettings,
    progress: &dyn Progress,
) -> Result<Trained, TrainError> {
    let task = Task::new(campaign, split, settings, progress)?;
    if !settings.effects.is_empty() && settings.method != Method::SecondOrder {
        return Err(TrainError::EffectsNeedSecondOrder);
    }
    let Search { restarts, best } = match &settings.method {
        Method::SecondOrder => second_order::search(&task),
        Method::Backprop(backprop) => backprop::search(&task, backprop)?,
    };
    let none = if progress.cancelled() { TrainError::Cancelled } else { TrainError::NoFiniteWeights };
    let best = best.filter(|candidate| candidate.cost.is_finite()).ok_or(none)?;
    let mut model = task.model(campaign, split, &best);
    let training = split.training.iter().filter_map(|&index| campaign.runs.get(index));
    if let Ok(Residuals { runs, .. }) = residuals(&model, training) {
        // What the device computes, not what the optimiser believed.
        model.provenance.training_residual = crate::noise::rms(runs.iter().flat_map(|run| &run.residuals_g));
    }
    let raw = Baseline { polynomial: Polynomial::fit_degrees(&task.data, 1, 0), scale: task.scale };
    let baseline = Baseline { polynomial: task.polynomial, scale: task.scale };
    Ok(Trained { model, restarts, baseline, raw })
}

impl<'a> Task<'a> {
    fn new(
        campaign: &'a Campaign,
        split: &Split,
        settings: &'a TrainSettings,
        progress: &'a dyn Progress,
    ) -> Result<Self, TrainError> {
        if settings.restarts == 0 {
            return Err(TrainError::NoRestarts);
        }
        let runs: Vec<(usize, &Run)> =
            split.training.iter().filter_map(|&index| Some((index, campaign.runs.get(index)?))).collect();
        let scale = InputScale::of(runs.iter().map(|(_, run)| *run)).ok_or(TrainError::NoTrainingRuns)?;
        let data: Vec<Datum> = runs.iter().flat_map(|(index, run)| merged(run, *index, &scale)).collect();
        let polynomial = Polynomial::fit(&data);
        let baseline = Baseline { polynomial, scale };
        let residuals: Vec<_> = runs.iter().map(|(_, run)| (*run, baseline.residuals_g(run))).collect();
        let sigma_g = sample_sigma_g(residuals.iter().map(|(run, residuals)| (*run, residuals)));
        let Baseline { polynomial, scale } = baseline;
        let runs: Vec<&Run> = runs.into_iter().map(|(_, run)| run).collect();
        Ok(Self {
            effects: settings.effects.iter().map(|choice| choose(choice, campaign, &runs)).collect::<Result<_, _>>()?,
            max_gap_us: max_gap_us(&runs),
            runs,
            data,
            scale,
            polynomial,
            sigma_g: sigma_g.unwrap_or(0.0).max(LEAST_SIGMA_G),
            settings,
            progress,
        })
    }

    /// Sources of scatter in the residuals of a fit of the training data.
    fn noise(&self, fit_g: impl Fn(&Datum) -> f64) -> Components {
        let mean = |datum: &Datum| Mean {
            run: datum.run,
            samples: datum.weight,
            residual_g: fit_g(datum) - datum.reference_g,
        };
        Components::estimate(self.sigma_g, &self.data.iter().map(mean).collect::<Vec<_>>())
    }

    fn model(&self, campaign: &Campaign, split: &Split, best: &Candidate) -> Model {
        let Weights { input, bias, output, output_bias } = best.weights;
        Model {
            format: Model::FORMAT,
            serial: self.settings.serial.clone(),
            provenance: self.provenance(campaign, split),
            units: Units {
                signal: campaign.quantity.signal_unit.clone(),
                reference: campaign.quantity.reference_unit.clone(),
            },
            scaling: ModelScaling {
                delta_f_zero_uhz: self.scale.delta_f_zero_uhz,
                delta_f_gain_per_hz: self.scale.delta_f_half_span_hz.recip() as f32,
                temperature_zero_uc: self.scale.temperature_zero_uc,
                temperature_gain_per_c: self.scale.temperature_half_span_c.recip() as f32,
                line_g: best.line_g.map(|value| value as f32),
                output_g: best.output_g as f32,
            },
            domain: self.domain(),
            network: ModelNetwork { input, bias, output, output_bias },
            channels: self.channels(campaign),
            effects: self.effects.iter().zip(&best.coefficients.values).map(|(e, v)| fitted(e, v, campaign)).collect(),
        }
    }

    /// The auxiliary channels that the effects follow, each once.
    fn channels(&self, campaign: &Campaign) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let used = self.effects.iter().filter(|effect| effect.about.channel.is_some());
        for name in used.filter_map(|effect| campaign.channels.get(effect.channel)) {
            if !names.contains(name) {
                names.push(name.clone());
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
            campaign: campaign.sha256.iter().map(|byte| format!("{byte:02x}")).collect(),
            method: self.settings.method.name().to_owned(),
            seed: self.settings.seed,
            restarts: self.settings.restarts,
            training_runs: names(&split.training),
            held_out_runs: names(&split.held_out),
            training_residual: 0.0,
        }
    }

    /// The training data's rectangle and a little more, so that noise at its edge raises no flag.
    fn domain(&self) -> ModelDomain {
        let half_f_uhz = (self.scale.delta_f_half_span_hz * 1e6 * (1.0 + DOMAIN_MARGIN)).ceil() as i64;
        let half_t_uc = (self.scale.temperature_half_span_c * 1e6 * (1.0 + DOMAIN_MARGIN)).ceil() as i32;
        let (f, t) = (self.scale.delta_f_zero_uhz, self.scale.temperature_zero_uc);
        ModelDomain {
            delta_f_uhz: [f - half_f_uhz, f + half_f_uhz],
            temperature_uc: [t.saturating_sub(half_t_uc), t.saturating_add(half_t_uc)],
            max_gap_us: self.max_gap_us,
        }
    }
}

/// Longer than any regular sampling of these runs, µs.
fn max_gap_us(runs: &[&Run]) -> u32 {
    let slowest_s = runs.iter().filter_map(|run| run.sample_interval_s()).fold(1.0, f64::max);
    (slowest_s * GAP_INTERVALS * 1e6).min(f64::from(u32::MAX)) as u32
}

/// Finds the effect and its channel.
fn choose(choice: &EffectChoice, campaign: &Campaign, runs: &[&Run]) -> Result<Chosen, TrainError> {
    let about = effect::about(&choice.name).ok_or_else(|| TrainError::UnknownEffect(choice.name.clone()))?;
    let Some(usual) = about.channel else { return Ok(Chosen { about, channel: 0, origin: 0.0 }) };
    let name = choice.channel.as_deref().unwrap_or(usual);
    let channel = campaign
        .channels
        .iter()
        .position(|channel| channel == name)
        .ok_or_else(|| TrainError::NoChannel { effect: choice.name.clone(), channel: name.to_owned() })?;
    let values: Vec<f64> = runs
        .iter()
        .flat_map(|run| &run.rows)
        .filter_map(|row| row.sample.channels.get(channel))
        .map(|micro| *micro as f64 * 1e-6)
        .collect();
    Ok(Chosen { about, channel, origin: crate::metrics::mean(&values) })
}

/// A fitted effect as the model file keeps it.
fn fitted(effect: &Chosen, values: &[f64], campaign: &Campaign) -> ModelEffect {
    let names = effect.about.parameters.iter().map(|parameter| parameter.name.to_owned());
    ModelEffect {
        name: effect.about.name.to_owned(),
        channel: effect.about.channel.and_then(|_| campaign.channels.get(effect.channel).cloned()),
        parameters: names.zip(values.iter().copied()).collect(),
    }
}

/// A sample is stale after this many sampling intervals.
const GAP_INTERVALS: f64 = 30.0;
/// Share of the half span by which the calibrated domain exceeds the training data.
const DOMAIN_MARGIN: f64 = 0.02;
/// Noise is never taken to be less than this, so that noiseless data give no division by zero, g.
const LEAST_SIGMA_G: f64 = 1e-9;
