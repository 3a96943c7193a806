//! An effect in the competition, and what came of it.

use crate::diagnose::answer::{Judged, Outcome};
use crate::diagnose::forward::{EffectSet, is_placed, name_of};
use crate::diagnose::problem::NoiseModels;
use crate::fit::at_bound::at_bound;
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
    /// Whether the campaign determines it.
    pub determined: bool,
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
        at_bound(self.effect.about, &self.values, range_c).is_some()
    }

    /// As it is told.
    pub fn judged(&self, outcome: Outcome) -> Judged {
        Judged { effect: name_of(&self.effect).to_owned(), delta_bic: self.delta_bic, held_out_ratio: None, outcome }
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
    /// The noise without it.
    pub noises: NoiseModels,
}

/// What came of one search.
#[derive(Clone, Debug)]
pub struct Searched {
    /// The effect that is missed most, if any is.
    pub found: Option<Found>,
    /// The best effect within its bounds, be it missed or not.
    pub best: Option<Contender>,
    /// Largest ΔBIC of an effect that would have to leave its physical bounds.
    pub at_bound: f64,
    /// The noise without it.
    pub noises: NoiseModels,
    /// All effects that were judged, each once.
    pub judged: Vec<Judged>,
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

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::effect;

    fn contender(name: &str, values: &[f64], delta_bic: f64) -> Contender {
        let effect = Chosen::of(effect::about(name).unwrap());
        Contender { effect, values: values.to_vec(), delta_bic, noises: None, determined: true }
    }

    #[test]
    fn what_sits_at_a_place_starts_anew_at_each_width_and_nothing_else_does() {
        let narrow = contender("mode-crossing", &[1e-4, 0.7, 20.0, 0.0], 1.0);
        let wide = contender("mode-crossing", &[1e-4, 2.0, 20.0, 0.0], 2.0);
        let elsewhere = contender("mode-crossing", &[3e-4, 0.7, 40.0, 5.0], 3.0);
        assert!(narrow.is_same_effect(&wide) && !narrow.is_same_start(&wide) && narrow.is_same_start(&elsewhere));
        let [soon, late] = [100.0, 900.0].map(|tau_s| contender("warm-up", &[1e-4, tau_s], 4.0));
        assert!(soon.is_same_start(&late) && !soon.is_same_start(&narrow));
        let best = best_of_each(vec![soon, elsewhere, late, wide, narrow]);
        let found: Vec<(&str, f64)> = best.iter().map(|one| (one.effect.about.name, one.values[1])).collect();
        assert_eq!(found, [("warm-up", 100.0), ("mode-crossing", 0.7)]);
    }
}
