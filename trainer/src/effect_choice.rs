//! Which physical effects a model is to have: what the user named, found among the effects and the campaign's channels.

use crate::campaign::{Campaign, Run};
use crate::expression::{Expression, ExpressionError, alike};
use crate::fit::effects::Chosen;
use crate::metrics::mean;
use crate::model::{Model, ModelEffect};
use crate::noise::rms;
use firmware_core::effect::{self, About};
use thiserror::Error;

/// The effect that a user's own expression is.
const EXPRESSION: &str = "expression";

/// A physical effect to fit.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectChoice {
    /// Its name.
    pub name: String,
    /// The campaign's channel that it follows, where not the effect's usual one.
    pub channel: Option<String>,
    /// What an effect of the user's own depends on.
    pub expression: Option<String>,
    /// Coefficients to start from, in the effect's order; `None` searches.
    pub start: Option<Vec<f64>>,
}

impl EffectChoice {
    /// The effect of this name, searched from scratch.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self { name: name.to_owned(), channel: None, expression: None, start: None }
    }

    /// An effect of one's own, searched from scratch.
    #[must_use]
    pub fn expression(text: &str) -> Self {
        Self { expression: Some(text.to_owned()), ..Self::named(EXPRESSION) }
    }

    /// What a person calls it: its name, or the expression that it is.
    #[must_use]
    pub fn title(&self) -> &str {
        self.expression.as_deref().unwrap_or(&self.name)
    }

    /// Whether both are the same effect.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        match (&self.expression, &other.expression) {
            (Some(text), Some(other)) => alike(text, other),
            (None, None) => self.name == other.name,
            _ => false,
        }
    }

    /// The effects of a model, to be fitted anew from where they are.
    #[must_use]
    pub fn of(model: &Model) -> Vec<Self> {
        let choice = |effect: &ModelEffect| Self {
            name: effect.name.clone(),
            channel: effect.channel.clone(),
            expression: effect.expression.clone(),
            start: effect.coefficients(&model.channels).ok(),
        };
        model.effects.iter().map(choice).collect()
    }
}

/// Why an effect can't be had.
#[derive(Debug, Error)]
pub enum EffectError {
    /// No effect has this name.
    #[error("there is no effect named `{0}`; `tempco effects` lists them")]
    UnknownEffect(String),
    /// The effect is real, but no device can foresee it.
    #[error("effect `{0}` can't be compensated: no device can foresee it (`tempco effects {0}` says why)")]
    NotOnDevice(String),
    /// Only oscillators lock in, and only what is counted has a clock.
    #[error("effect `{effect}` is one of signals that are frequencies, and this one is measured in `{unit}`")]
    NeedsFrequency {
        /// The effect.
        effect: String,
        /// Unit of the campaign's signal.
        unit: String,
    },
    /// The campaign lacks the effect's channel.
    #[error("effect `{effect}` follows the channel `{channel}`, which the campaign doesn't have")]
    NoChannel {
        /// The effect.
        effect: String,
        /// Its channel.
        channel: String,
    },
    /// An effect of the user's own doesn't say what it depends on.
    #[error("effect `expression` needs to be told what it depends on: --expression \"supply_v * temperature_rate\"")]
    NoExpression,
    /// It does, and that is wrong.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// What it depends on doesn't vary.
    #[error(
        "expression `{0}` is the same in every row of the training runs, or has no value there: nothing can be learnt of it"
    )]
    Constant(String),
}

/// Finds the effect and its channel.
pub(crate) fn choose(choice: &EffectChoice, campaign: &Campaign, runs: &[&Run]) -> Result<Chosen, EffectError> {
    let about = effect::about(&choice.name).ok_or_else(|| EffectError::UnknownEffect(choice.name.clone()))?;
    if !about.is_on_device() {
        return Err(EffectError::NotOnDevice(choice.name.clone()));
    }
    if about.needs_frequency && !campaign.quantity.is_frequency() {
        let unit = campaign.quantity.signal_unit.clone();
        return Err(EffectError::NeedsFrequency { effect: choice.name.clone(), unit });
    }
    if about.takes_program() {
        return choose_expression(about, choice, campaign, runs);
    }
    let Some(usual) = about.channel else { return Ok(Chosen::of(about)) };
    let name = choice.channel.as_deref().unwrap_or(usual);
    let channel = campaign
        .channels
        .iter()
        .position(|channel| channel == name)
        .ok_or_else(|| EffectError::NoChannel { effect: choice.name.clone(), channel: name.to_owned() })?;
    let values: Vec<f64> = runs
        .iter()
        .flat_map(|run| &run.rows)
        .filter_map(|row| row.sample.channels.get(channel))
        .map(|micro| *micro as f64 * 1e-6)
        .collect();
    Ok(Chosen { channel, origin: mean(&values), ..Chosen::of(about) })
}

/// Reads the expression and finds out how large it is.
fn choose_expression(
    about: &'static About,
    choice: &EffectChoice,
    campaign: &Campaign,
    runs: &[&Run],
) -> Result<Chosen, EffectError> {
    let text = choice.expression.as_deref().ok_or(EffectError::NoExpression)?;
    let expression = Some(Expression::parse(text, &campaign.channels)?);
    let chosen = Chosen { expression, ..Chosen::of(about) };
    let max_gap_us = campaign.max_gap_us();
    let course_g: Vec<f64> = runs.iter().flat_map(|run| chosen.course_g(run, max_gap_us)).collect();
    let mean_g = mean(&course_g);
    let size = rms(&course_g);
    let scatter = rms(course_g.iter().map(|value_g| value_g - mean_g).collect::<Vec<_>>().iter());
    if scatter > size * LEAST_VARIATION {
        Ok(Chosen { size, ..chosen })
    } else {
        Err(EffectError::Constant(text.to_owned()))
    }
}

/// What varies by less than this share of its size can't be told from the bias.
const LEAST_VARIATION: f64 = 1e-6;
