//! The noise of difference and sum.

use super::Problem;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::noise::{InitialStates, NoiseModel};
use std::sync::Arc;

/// Noise of difference and sum.
#[derive(Clone, Debug)]
pub struct NoiseModels {
    /// Of the residual, µg.
    pub delta: NoiseModel,
    /// Of the sum of the frequencies, mHz.
    pub sum: Option<NoiseModel>,
    /// How much is left of the initial states of the effects that it is the noise beside.
    pub initial: Arc<InitialStates>,
}

impl NoiseModels {
    /// No part larger than the sample noise: what an effect hides behind is not taken for noise.
    pub fn small(&self) -> Self {
        Self { delta: self.delta.small(), sum: self.sum.map(|noise| noise.small()), initial: self.initial.clone() }
    }

    /// The same parts with the noise of a sample, and of a °C unseen, of this problem.
    pub fn of(&self, problem: &Problem) -> Self {
        let mut noises = self.clone();
        (noises.delta.sample, noises.delta.per_c) = (problem.sample_ug, problem.ug_per_c);
        noises
    }

    /// The same sizes beside other effects.
    pub fn beside(&self, initial: &Arc<InitialStates>) -> Self {
        Self { initial: initial.clone(), ..*self }
    }
}

/// How much of these effects' initial states is left in the cells.
pub fn initial_states(problem: &Problem, set: &EffectSet) -> Arc<InitialStates> {
    Arc::new(InitialStates::of(problem.cells(), set))
}
