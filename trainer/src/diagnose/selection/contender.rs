//! An effect in the competition, and what came of it.

use crate::diagnose::forward::{EffectSet, is_placed, name_of};
use crate::diagnose::problem::NoiseModels;
use crate::diagnose::thresholds::AT_BOUND;
use crate::fit::effects::Chosen;
use firmware_core::effect::Role;
use std::ops::RangeInclusive;

/// How well one effect does.
#[derive(Clone, Debug)]
pub struct Contender {
    /// The effect.
    pub effect: Chosen,
    /// Its fitted coefficients.
    pub values: Vec<f64>,
    /// Twice the logarithm of the likelihood ratio with and without it, less k·ln n for its k parameters.
    pub delta_bic: f64,
    /// The noise that it leaves, once it is estimated.
    pub noises: Option<NoiseModels>,
}

impl Contender {
    /// Whether both are the same effect.
    pub fn is_same_effect(&self, other: &Self) -> bool {
        name_of(&self.effect) == name_of(&other.effect)
    }

    /// Whether one fit would end where the other does: what sits at a place has a valley for each width.
    pub fn is_same_start(&self, other: &Self) -> bool {
        let mut parameters = self.effect.about.parameters.iter().zip(self.values.iter().zip(&other.values));
        let mut width_differs = || parameters.any(|(about, (a, b))| about.role == Role::Shape && a != b);
        self.is_same_effect(other) && !(is_placed(self.effect.about) && width_differs())
    }

    /// Whether a shape was stopped by the bound of what makes physical sense, or sits where nothing was measured:
    /// then it is something else.
    pub fn is_at_bound(&self, range_c: &RangeInclusive<f64>) -> bool {
        let mut parameters = self.effect.about.parameters.iter().zip(&self.values);
        parameters.any(|(parameter, value)| match parameter.role {
            Role::Shape => {
                (*value < parameter.low * AT_BOUND && !parameter.sound_limit.is_low())
                    || (*value * AT_BOUND > parameter.high && !parameter.sound_limit.is_high())
            }
            Role::Location if parameter.unit == "°C" => {
                let reach_c = self.reach_c_per_g();
                *value + reach_c < *range_c.start() || *value - reach_c > *range_c.end()
            }
            Role::Location | Role::Amplitude | Role::Origin => false,
        })
    }

    /// How far 1 g moves the place where the effect sits, °C.
    fn reach_c_per_g(&self) -> f64 {
        let pairs = self.effect.about.parameters.iter().zip(&self.values);
        pairs.filter(|(parameter, _)| parameter.unit == "°C/g").map(|(_, value)| value.abs()).sum()
    }

    /// The effect by itself.
    pub fn alone(&self) -> EffectSet {
        EffectSet::NONE.with(&self.effect, &self.values)
    }
}

/// One effect that was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The winner.
    pub winner: Contender,
    /// The others in order.
    pub rivals: Vec<Contender>,
    /// Largest ΔBIC of an effect that would have to leave its physical bounds.
    pub at_bound: f64,
    /// The noise without it.
    pub noises: NoiseModels,
}

/// The first of every effect.
pub fn best_of_each(order: Vec<Contender>) -> Vec<Contender> {
    let mut best: Vec<Contender> = Vec::new();
    for contender in order {
        if !best.iter().any(|other| other.is_same_effect(&contender)) {
            best.push(contender);
        }
    }
    best
}
