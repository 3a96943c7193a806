//! What every method of the tables learns from, and how one is told to learn.

use crate::campaign::{Campaign, Split};
use crate::effect_choice::EffectChoice;
use crate::fit::gradient_descent;
use crate::progress::Progress;
use crate::train::{Backprop, Method, TrainError, TrainSettings, Trained, train};

/// What every method learns from, and under which conditions.
#[derive(Clone, Copy)]
pub struct Lesson<'a> {
    /// All runs.
    pub campaign: &'a Campaign,
    /// Which of them teach.
    pub split: &'a Split,
    /// Trainings from different starts, of which the best is kept; the paper makes 30.
    pub restarts: usize,
    /// Passes of a gradient descent.
    pub passes: usize,
    /// Seed of every random number.
    pub seed: u64,
    /// Who watches.
    pub progress: &'a dyn Progress,
}

impl Lesson<'_> {
    /// The settings of a method under these conditions.
    #[must_use]
    pub fn settings(&self, method: Method) -> TrainSettings {
        TrainSettings { method, restarts: self.restarts, ..TrainSettings::new(self.seed) }
    }

    /// Trains with these settings.
    ///
    /// # Errors
    /// As [`train`].
    pub fn learn(&self, settings: &TrainSettings) -> Result<Trained, TrainError> {
        train(self.campaign, self.split, settings, self.progress)
    }

    /// Trains as the paper does.
    pub(super) fn descend(&self, swarm: Backprop) -> Result<Trained, TrainError> {
        let descent = gradient_descent::Settings { iterations: self.passes, ..swarm.descent };
        self.learn(&self.settings(Method::Backprop(Backprop { descent, ..swarm })))
    }

    /// Trains by the default method, with these effects.
    pub(super) fn second_order(&self, effects: &[&str]) -> Result<Trained, TrainError> {
        let effects = effects.iter().copied().map(EffectChoice::named).collect();
        self.learn(&TrainSettings { effects, ..self.settings(Method::SecondOrder) })
    }
}
