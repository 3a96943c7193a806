//! An effect as the model file keeps it.

use super::error::DeviceLimit;
use crate::expression::Expression;
use firmware_core::effect::{self, Parameter};
use protocol::Term;
use protocol::limits::MAX_PARAMETERS;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One effect with its fitted coefficients.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelEffect {
    /// Name of the effect.
    pub name: String,
    /// The auxiliary channel that it follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// What an effect of the user's own depends on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expression: Option<String>,
    /// Coefficients by name.
    pub parameters: BTreeMap<String, f64>,
}

impl ModelEffect {
    /// What a person calls it: its name, or the expression that it is.
    #[must_use]
    pub fn title(&self) -> &str {
        self.expression.as_deref().unwrap_or(&self.name)
    }

    /// The coefficients in the effect's order; one that means nothing to its expression is not in the file.
    ///
    /// # Errors
    /// [`DeviceLimit`] if one is missing or surplus, or the expression is wrong.
    pub fn coefficients(&self, channels: &[String]) -> Result<Vec<f64>, DeviceLimit> {
        let about = self.about()?;
        let expression = self.parsed(about, channels)?;
        let idle = |parameter: &Parameter| expression.as_ref().is_some_and(|text| text.leaves_idle(parameter));
        let expected: Vec<&str> = about.parameters.iter().filter(|p| !idle(p)).map(|p| p.name).collect();
        let wrong = || DeviceLimit::Coefficients {
            effect: self.name.clone(),
            found: self.parameters.keys().map(String::as_str).collect::<Vec<_>>().join(", "),
            expected: expected.join(", "),
        };
        if self.parameters.len() != expected.len() {
            return Err(wrong());
        }
        let value = |parameter: &Parameter| {
            if idle(parameter) { Some(parameter.start) } else { self.parameters.get(parameter.name).copied() }
        };
        about.parameters.iter().map(value).collect::<Option<_>>().ok_or_else(wrong)
    }

    /// As a device stores it.
    pub(super) fn to_term(&self, channels: &[String]) -> Result<Term, DeviceLimit> {
        let about = self.about()?;
        let coefficients = self.coefficients(channels)?;
        let channel = match (&self.channel, about.channel) {
            (None, None) => 0,
            (Some(name), Some(_)) => channels
                .iter()
                .position(|channel| channel == name)
                .ok_or_else(|| DeviceLimit::Channel { effect: self.name.clone() })?,
            _ => return Err(DeviceLimit::Channel { effect: self.name.clone() }),
        };
        Ok(Term {
            effect: about.id,
            channel: u8::try_from(channel).unwrap_or(u8::MAX),
            parameters: coefficients.iter().take(MAX_PARAMETERS).map(|value| *value as f32).collect(),
            program: self.parsed(about, channels)?.map(|expression| expression.code().clone()).unwrap_or_default(),
        })
    }

    fn about(&self) -> Result<&'static effect::About, DeviceLimit> {
        effect::about(&self.name).ok_or_else(|| DeviceLimit::UnknownEffect(self.name.clone()))
    }

    fn parsed(&self, about: &effect::About, channels: &[String]) -> Result<Option<Expression>, DeviceLimit> {
        let wrong = |wrong| DeviceLimit::Expression { effect: self.name.clone(), wrong };
        match (&self.expression, about.takes_program()) {
            (Some(text), true) => Ok(Some(Expression::parse(text, channels)?)),
            (None, false) => Ok(None),
            (None, true) => Err(wrong("needs an expression")),
            (Some(_), false) => Err(wrong("takes no expression")),
        }
    }
}
