//! The methods of the tables. Another one is another line of [`COLUMNS`].

use super::unconstrained;
use crate::campaign::{Campaign, Split};
use crate::effect_choice::EffectChoice;
use crate::fit::gradient_descent;
use crate::progress::Progress;
use crate::train::{Backprop, Method, TrainError, TrainSettings, Trained, train};

/// One method of the tables.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// What it is called.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub about: &'static str,
    /// How it learns.
    pub train: fn(&Lesson) -> Result<Trained, TrainError>,
}

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

/// Name of the paper's comparison among [`COLUMNS`].
pub const FA_BP: &str = "FA-BP";
/// Name of the paper's method.
pub const IFA_BP: &str = "IFA-BP";
/// Name of the default method.
pub const DEFAULT: &str = "default";

/// The methods, in the order of the tables.
pub const COLUMNS: [Column; 5] = [
    Column {
        name: FA_BP,
        about: "gradient descent from a standard firefly swarm",
        train: |lesson| lesson.descend(Backprop::standard()),
    },
    Column {
        name: IFA_BP,
        about: "gradient descent from an improved firefly swarm",
        train: |lesson| lesson.descend(Backprop::improved()),
    },
    Column {
        name: "plain LM",
        about: "the paper's 41 weights by Levenberg–Marquardt from random starts, nothing held to anything",
        train: unconstrained::train,
    },
    Column {
        name: DEFAULT,
        about: "second order with the slope held to the measured scale factor",
        train: |lesson| lesson.second_order(&[]),
    },
    Column {
        name: "+ warm-up",
        about: "the default with the effect `warm-up` beside the network",
        train: |lesson| lesson.second_order(&["warm-up"]),
    },
];

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

    fn descend(&self, swarm: Backprop) -> Result<Trained, TrainError> {
        let descent = gradient_descent::Settings { iterations: self.passes, ..swarm.descent };
        self.learn(&self.settings(Method::Backprop(Backprop { descent, ..swarm })))
    }

    fn second_order(&self, effects: &[&str]) -> Result<Trained, TrainError> {
        let effects = effects.iter().copied().map(EffectChoice::named).collect();
        self.learn(&TrainSettings { effects, ..self.settings(Method::SecondOrder) })
    }
}
