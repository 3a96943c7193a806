//! Effects with their coefficients.

use crate::expression::Expression;
use crate::fit::effects::{Chosen, Coefficients};
use firmware_core::Memory;
use firmware_core::effect::{self, About, Role};
use protocol::limits::MAX_PARAMETERS;

/// Effects with their coefficients.
#[derive(Clone, Debug)]
pub struct EffectSet {
    /// The effects.
    pub effects: Vec<Chosen>,
    /// Their coefficients.
    pub coefficients: Coefficients,
}

impl EffectSet {
    /// No effects.
    pub const NONE: Self = Self { effects: Vec::new(), coefficients: Coefficients { values: Vec::new() } };

    /// These and one more.
    pub fn with(&self, effect: &Chosen, values: &[f64]) -> Self {
        let mut set = self.clone();
        set.effects.push(effect.clone());
        set.coefficients.values.push(values.to_vec());
        set
    }

    /// These and others.
    pub fn and(&self, others: &Self) -> Self {
        let mut set = self.clone();
        set.effects.extend(others.effects.iter().cloned());
        set.coefficients.values.extend(others.coefficients.values.iter().cloned());
        set
    }

    /// The same effects with other parameters, held within their bounds.
    pub fn at(&self, parameters: &[f64]) -> Self {
        let coefficients = Coefficients::from_parameters(&self.effects, parameters);
        Self { effects: self.effects.clone(), coefficients }
    }

    /// Each by itself.
    pub fn each(&self) -> impl Iterator<Item = Self> {
        self.effects.iter().zip(&self.coefficients.values).map(|(effect, values)| Self::NONE.with(effect, values))
    }

    /// How far each free parameter may be from where it is, in the optimiser's units: an amplitude by all of it, a shape by
    /// a factor of e, a place by the effect's own width.
    pub fn reaches(&self) -> Vec<f64> {
        let parameters = self.coefficients.to_parameters(&self.effects);
        let free = self.effects.iter().zip(&self.coefficients.values).flat_map(|(effect, values)| {
            let width = effect.about.parameters.iter().zip(values).find(|(about, _)| about.role == Role::Shape);
            let width = width.map_or(1.0, |(_, width)| *width);
            effect.free().map(move |about| (about.role, width))
        });
        free.zip(parameters)
            .map(|((role, width), parameter)| match role {
                Role::Amplitude => parameter.abs(),
                Role::Shape => 1.0,
                Role::Location | Role::Origin => width,
            })
            .collect()
    }

    /// One effect with a time constant so many times as long; `None` of one that remembers nothing, or beyond its bounds.
    pub fn with_tau_times(&self, ratio: f64) -> Option<Self> {
        let about = self.effects.first()?.about;
        let remembers = self.memories().any(|memory| matches!(memory, Memory::Lag { .. }));
        let place = about.parameters.iter().position(|about| about.role == Role::Shape).filter(|_| remembers)?;
        let mut values = self.coefficients.values.first()?.clone();
        let bounds = about.parameters[place].low..=about.parameters[place].high;
        *values.get_mut(place)? *= ratio;
        bounds.contains(&values[place]).then(|| Self::NONE.with(&self.effects[0], &values))
    }

    /// What each of them remembers.
    pub fn memories(&self) -> impl Iterator<Item = Memory<f64>> {
        self.effects.iter().zip(&self.coefficients.values).map(|(chosen, values)| {
            let mut coefficients = [0.0; MAX_PARAMETERS];
            coefficients.iter_mut().zip(values).for_each(|(slot, value)| *slot = *value);
            let leaves_idle = |text: &Expression| chosen.about.parameters.iter().any(|about| text.leaves_idle(about));
            let idle = chosen.expression.as_ref().is_some_and(leaves_idle);
            let effect = effect::find::<f64>(chosen.about.id).filter(|_| !idle);
            effect.map_or(Memory::None, |effect| effect.memory(&coefficients))
        })
    }

    /// Those of which this is true, and the others.
    pub(super) fn split(&self, is: impl Fn(&About) -> bool) -> (Self, Self) {
        let mut both = (Self::NONE, Self::NONE);
        for (effect, values) in self.effects.iter().zip(&self.coefficients.values) {
            let side = if is(effect.about) { &mut both.0 } else { &mut both.1 };
            side.effects.push(effect.clone());
            side.coefficients.values.push(values.clone());
        }
        both
    }

    /// Of each free parameter, whether the effect predicts the sum of the frequencies.
    pub fn predicts(&self) -> impl Iterator<Item = bool> {
        self.effects.iter().flat_map(|effect| effect.free().map(|_| effect.about.sum_response.is_predicted()))
    }

    /// Those whose contributions predict the sum of the frequencies.
    pub fn sum_predicted(&self) -> Self {
        self.split(|about| about.sum_response.is_predicted()).0
    }

    /// Those that leave the sum free.
    pub fn sum_free(&self) -> Self {
        self.split(|about| about.sum_response.is_predicted()).1
    }

    /// These but the one at `index`.
    pub fn without(&self, index: usize) -> Self {
        let mut set = self.clone();
        set.effects.remove(index);
        set.coefficients.values.remove(index);
        set
    }
}

/// Whether the effect sits at a place.
pub fn is_placed(about: &About) -> bool {
    about.parameters.iter().any(|parameter| parameter.role == Role::Location)
}

/// Indices of the amplitudes among an effect's parameters.
pub fn amplitudes(about: &About) -> Vec<usize> {
    let parameters = about.parameters.iter().enumerate();
    parameters.filter(|(_, about)| about.role == Role::Amplitude).map(|(index, _)| index).collect()
}

/// What an effect is called: its name, or the formula.
pub fn name_of(effect: &Chosen) -> &str {
    effect.expression.as_ref().map_or(effect.about.name, Expression::text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(name: &str, values: &[f64]) -> EffectSet {
        EffectSet::NONE.with(&Chosen::of(effect::about(name).unwrap()), values)
    }

    fn all() -> EffectSet {
        let crossing = one("mode-crossing", &[2e-4, 2.0, 25.0, 10.0]);
        one("thermal-lag", &[60.0]).and(&one("thermal-gradient", &[-5e-3, 8.0])).and(&crossing)
    }

    fn names(set: &EffectSet) -> Vec<&str> {
        set.effects.iter().map(name_of).collect()
    }

    #[test]
    fn a_set_is_divided_by_what_predicts_the_sum_each_with_its_values() {
        let all = all();
        let (predicted, free) = (all.sum_predicted(), all.sum_free());
        assert_eq!(names(&predicted), ["thermal-lag"]);
        assert_eq!(predicted.coefficients.values, [[60.0]]);
        assert_eq!(names(&free), ["thermal-gradient", "mode-crossing"]);
        assert_eq!(free.coefficients.values[0], [-5e-3, 8.0]);
        assert_eq!(all.predicts().collect::<Vec<_>>(), [true, false, false, false, false, false, false]);
        assert_eq!(names(&all.without(1)), ["thermal-lag", "mode-crossing"]);
        assert_eq!(all.without(0).coefficients.values[0], [-5e-3, 8.0]);
    }

    #[test]
    fn reaches_are_the_size_of_an_amplitude_a_factor_for_a_shape_and_a_width_for_a_place() {
        assert_eq!(all().reaches(), [1.0, 5e-3, 1.0, 2e-4, 1.0, 2.0, 2.0]);
    }

    #[test]
    fn parameters_beyond_the_bounds_are_held_at_them_and_each_effect_remembers_its_own() {
        let moved = all().at(&[60.0_f64.ln(), 7.0, 1e3_f64.ln(), 2e-4, 0.5_f64.ln(), 20.0, 0.0]);
        assert!((moved.coefficients.values[1][0] - 0.1).abs() < 1e-12, "{:?}", moved.coefficients.values);
        assert!((moved.coefficients.values[1][1] - 300.0).abs() < 1e-9);
        let memories: Vec<_> = all().memories().collect();
        assert_eq!(memories, [Memory::Lag { tau_s: 60.0 }, Memory::Lag { tau_s: 8.0 }, Memory::None]);
        assert_eq!(amplitudes(all().effects[2].about), [0]);
        assert!(is_placed(all().effects[2].about) && !is_placed(all().effects[0].about));
    }
}
