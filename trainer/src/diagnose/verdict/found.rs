//! What has been found so far.

use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::NoiseModels;
use crate::diagnose::selection::{Contender, Found};

/// What was found, one after the other.
pub struct Findings {
    /// All effects, those that the model has first.
    pub known: EffectSet,
    /// In the order in which they were found.
    pub steps: Vec<Found>,
    /// The noise with all of them.
    pub noises: NoiseModels,
    /// Largest ΔBIC of what would have to leave its physical bounds, at the end.
    pub at_bound: f64,
    /// A channel's course that explains what no effect does.
    pub formula: Option<Contender>,
}

impl Findings {
    /// Nothing beside what is known.
    pub fn nothing_yet(known: EffectSet, noises: NoiseModels) -> Self {
        Self { known, steps: Vec::new(), noises, at_bound: f64::NEG_INFINITY, formula: None }
    }
}
