//! What has been found so far.

use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{NoiseModels, Problem};
use crate::diagnose::selection::{Contender, Found};

/// What was found, one after the other.
pub struct Findings<'a> {
    /// All effects, those that the model has first.
    pub known: EffectSet,
    /// The problem seen from where they are at work.
    pub problem: Problem<'a>,
    /// In the order in which they were found.
    pub steps: Vec<Found>,
    /// The noise with all of them.
    pub noises: NoiseModels,
    /// Largest ΔBIC of what would have to leave its physical bounds, at the end.
    pub at_bound: f64,
    /// A channel's course that explains what no effect does.
    pub formula: Option<Contender>,
}

impl<'a> Findings<'a> {
    /// Nothing beside what is known.
    pub fn nothing_yet(problem: Problem<'a>, known: EffectSet, noises: NoiseModels) -> Self {
        Self { known, problem, steps: Vec::new(), noises, at_bound: f64::NEG_INFINITY, formula: None }
    }
}
