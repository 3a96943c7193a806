//! The methods of the tables. Another one is another line of [`COLUMNS`].

use super::lesson::Lesson;
use super::unconstrained;
use crate::train::{Backprop, TrainError, Trained};

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
