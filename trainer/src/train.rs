//! From training runs to a model.

mod backprop;
mod baseline;
mod error;
mod search;
mod second_order;
mod settings;
mod task;

pub use crate::effect_choice::EffectChoice;
pub use baseline::Baseline;
pub use error::TrainError;
pub use search::Restart;
pub use settings::{Anchoring, Backprop, Method, Swarm, TrainSettings};

use crate::campaign::{Campaign, Run, Split};
use crate::diagnose;
use crate::fit::polynomial::Polynomial;
use crate::model::Model;
use crate::progress::{Progress, Quiet};
use crate::residuals::{Residuals, arranged, residuals};
use crate::yardstick::Yardstick;
use search::Search;
use task::Task;

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

/// Whether these settings could be trained, found out without training.
///
/// # Errors
/// [`TrainError`] says what is missing.
pub fn check(campaign: &Campaign, split: &Split, settings: &TrainSettings) -> Result<(), TrainError> {
    let yardstick = yardstick_of(campaign, settings)?;
    Task::new(&yardstick.campaign(campaign), split, &inside(&yardstick, settings), yardstick, &Quiet).map(|_| ())
}

fn yardstick_of(campaign: &Campaign, settings: &TrainSettings) -> Result<Yardstick, TrainError> {
    Yardstick::of_training(campaign, settings.scale_factor_hz_per_g, &settings.effects).ok_or(TrainError::Numbers)
}

/// Settings in the units of the work.
fn inside(yardstick: &Yardstick, settings: &TrainSettings) -> TrainSettings {
    TrainSettings {
        scale_factor_hz_per_g: settings.scale_factor_hz_per_g.map(|stated| yardstick.scale_factor_inside(stated)),
        effects: yardstick.choices_inside(&settings.effects),
        ..settings.clone()
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
    let yardstick = yardstick_of(campaign, settings)?;
    let (scaled, stated) = (yardstick.campaign(campaign), inside(&yardstick, settings));
    let task = Task::new(&scaled, split, &stated, yardstick, progress)?;
    if !settings.effects.is_empty() && settings.method != Method::SecondOrder {
        return Err(TrainError::EffectsNeedSecondOrder);
    }
    if settings.effects.iter().all(|choice| choice.start.is_some()) {
        return fitted(campaign, split, settings, task);
    }
    let started = inside(&yardstick, &started_well(campaign, split, settings, progress)?);
    fitted(campaign, split, settings, Task::new(&scaled, split, &started, yardstick, progress)?)
}

/// The model of a task that is ready to be fitted; `stated` are its settings in the campaign's own units.
fn fitted(campaign: &Campaign, split: &Split, stated: &TrainSettings, task: Task) -> Result<Trained, TrainError> {
    let (settings, progress) = (task.settings, task.progress);
    progress.begins(settings.restarts);
    let Search { restarts, best } = match &settings.method {
        Method::SecondOrder => second_order::search(&task),
        Method::Backprop(backprop) => backprop::search(&task, backprop)?,
    };
    let none = if progress.cancelled() { TrainError::Cancelled } else { TrainError::NoFiniteWeights };
    let best = best.filter(|candidate| candidate.cost.is_finite()).ok_or(none)?;
    let mut model = task.model(campaign, split, &best);
    if !is_representable(&model) {
        return Err(TrainError::Numbers);
    }
    model.provenance.scale_factor_hz_per_g = stated.scale_factor_hz_per_g;
    model.to_blob().map_err(TrainError::Unusable)?;
    if let Some(residual) = training_residual(&model, campaign, split) {
        model.provenance.training_residual = residual;
    }
    let outside = |polynomial| Baseline { polynomial, scale: task.scale }.outside(&task.yardstick);
    let raw = outside(Polynomial::fit_degrees(&task.data, 1, 0));
    let restarts =
        restarts.into_iter().map(|one| Restart { residual_g: task.yardstick.outside(one.residual_g), ..one });
    let restarts = restarts.collect();
    let baseline = outside(task.polynomial);
    Ok(Trained { model, restarts, baseline, raw })
}

/// Whether a device's 32-bit numbers hold the model's readings with all their digits.
fn is_representable(model: &Model) -> bool {
    let largest = model
        .scaling
        .line_g
        .iter()
        .chain([&model.scaling.output_g])
        .fold(0.0, |most: f32, value| most.max(value.abs()));
    let finite = model.scaling.line_g.iter().chain([&model.scaling.output_g]).all(|value| value.is_finite());
    finite && (LEAST_READING..=LEAST_READING.recip()).contains(&largest)
}

/// Beyond this and its reciprocal 32-bit numbers lose digits in products.
const LEAST_READING: f32 = 1e-30;

/// Restarts of the static model beside which effects find their start.
const STATIC_RESTARTS: usize = 4;

/// The settings with a start for every effect. A joint fit weighs states and runs by how they scatter, and the scatter of
/// a static fit has the effect in it; a diagnosis, which fits effect and noise in turn, is not misled by that.
fn started_well(
    campaign: &Campaign,
    split: &Split,
    settings: &TrainSettings,
    progress: &dyn Progress,
) -> Result<TrainSettings, TrainError> {
    let restarts = settings.restarts.min(STATIC_RESTARTS);
    let alone = TrainSettings { effects: Vec::new(), restarts, ..settings.clone() };
    let model = train(campaign, split, &alone, progress)?.model;
    let training = split.training.iter().filter_map(|&index| campaign.runs.get(index)).cloned().collect();
    let training = Campaign::new(training, campaign.channels.clone(), campaign.quantity.clone());
    let effects = diagnose::starts(&model, &training, &settings.effects);
    Ok(TrainSettings { effects: effects.unwrap_or_else(|| settings.effects.clone()), ..settings.clone() })
}

/// RMS on the training runs of what the device computes, not of what the optimiser believed.
fn training_residual(model: &Model, campaign: &Campaign, split: &Split) -> Option<f64> {
    let campaign = arranged(model, campaign).ok()?;
    let training = split.training.iter().filter_map(|&index| campaign.runs.get(index));
    let Residuals { runs } = residuals(model, training).ok()?;
    Some(crate::noise::rms(runs.iter().flat_map(|run| &run.residuals_g)))
}
