//! The parts of the noise and their sizes: repeatability components from run to run, from mounting to mounting, from
//! position to position and from node to node, and what wanders.

use super::initial_state::PLACES;
use crate::diagnose::thresholds::{FIRST_WALK, SMALL_WALK, WALK_S};
use std::ops::{Index, IndexMut};

/// A part of the noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// From run to run: turn-on, µg.
    Run,
    /// From run to run, µg per g across the input axis: each run is taken for a mounting of its own.
    Mounting,
    /// From position to position, µg per g across the input axis: a table's errors.
    Position,
    /// From soaked node to soaked node, µg.
    Node,
    /// Wander within minutes, µg.
    Flicker,
    /// Wander within hours, µg.
    Wander,
    /// Random walk, µg/√s.
    Walk,
    /// From position to position, whatever acceleration lies across the input axis, µg: no table does that.
    Pose,
    /// Wander within hours, µg per g across the input axis: at one level a rig stands in two ways, and nobody wrote down
    /// in which.
    Turn,
    /// Unknown initial states of effects with a memory: here the first effect's, then the others', µg.
    Initial(usize),
}

/// How many parts there are.
const COUNT: usize = 9 + PLACES;

impl Component {
    /// All of them, in the order of their places.
    pub const ALL: [Self; COUNT] = [
        Self::Run,
        Self::Mounting,
        Self::Position,
        Self::Node,
        Self::Flicker,
        Self::Wander,
        Self::Walk,
        Self::Pose,
        Self::Turn,
        Self::Initial(0),
        Self::Initial(1),
        Self::Initial(2),
        Self::Initial(3),
    ];

    const fn place(self) -> usize {
        match self {
            Self::Run => 0,
            Self::Mounting => 1,
            Self::Position => 2,
            Self::Node => 3,
            Self::Flicker => 4,
            Self::Wander => 5,
            Self::Walk => 6,
            Self::Pose => 7,
            Self::Turn => 8,
            Self::Initial(effect) => 9 + effect,
        }
    }

    /// Whether it wanders within a run: what is periodic may be taken for it.
    pub const fn wanders(self) -> bool {
        match self {
            Self::Flicker | Self::Wander | Self::Walk | Self::Turn => true,
            Self::Run | Self::Mounting | Self::Position | Self::Node | Self::Pose | Self::Initial(_) => false,
        }
    }

    /// Whether it comes with a start, a mounting or a position: a map trained on few runs follows its mean.
    pub const fn is_of_the_rig(self) -> bool {
        match self {
            Self::Run | Self::Mounting | Self::Position | Self::Turn => true,
            Self::Node | Self::Flicker | Self::Wander | Self::Walk | Self::Pose | Self::Initial(_) => false,
        }
    }

    /// Whether it scatters within a run about a mean, so that no model can remove it there: a run's own offset is left out
    /// of what is predictable, and a walk has no mean.
    pub const fn scatters_within_runs(self) -> bool {
        match self {
            Self::Position | Self::Node | Self::Flicker | Self::Wander | Self::Pose | Self::Turn => true,
            Self::Run | Self::Mounting | Self::Walk | Self::Initial(_) => false,
        }
    }

    /// The unit in which its size is compared with that of others: the noise of a sample, in µg or mHz; per g across the
    /// input axis for what a rig does; for a walk what adds up to it in [`WALK_S`], per √s.
    pub fn unit(self, sample: f64) -> f64 {
        match self {
            Self::Walk => sample / WALK_S.sqrt(),
            _ => sample,
        }
    }
}

/// Standard deviations of the parts of the noise: of the residual in µg, of the sum of the frequencies in mHz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Of a sample.
    pub sample: f64,
    /// What a °C unseen is worth.
    pub per_c: f64,
    sizes: [f64; COUNT],
}

impl Index<Component> for NoiseModel {
    type Output = f64;

    fn index(&self, component: Component) -> &f64 {
        &self.sizes[component.place()]
    }
}

impl IndexMut<Component> for NoiseModel {
    fn index_mut(&mut self, component: Component) -> &mut f64 {
        &mut self.sizes[component.place()]
    }
}

impl NoiseModel {
    /// Every part as large as a sample's noise.
    pub fn even(sample: f64, per_c: f64) -> Self {
        Self { sample, per_c, sizes: [sample; COUNT] }
    }

    /// Where an estimate begins: every part about as large as the sample noise, none for what must prove itself
    /// ([`Component::Turn`]).
    pub fn first_guess(sample: f64, per_c: f64) -> Self {
        let mut guess = Self::even(sample, per_c);
        guess[Component::Walk] = Component::Walk.unit(sample) * FIRST_WALK;
        guess[Component::Turn] = 0.0;
        guess
    }

    /// The same with no part larger than the sample noise, initial states aside.
    pub fn small(&self) -> Self {
        let mut small = *self;
        for component in Component::ALL {
            if !matches!(component, Component::Initial(_)) {
                small[component] = small[component].min(self.sample);
            }
        }
        small[Component::Walk] = small[Component::Walk].min(self.sample * SMALL_WALK);
        small
    }

    /// The same with no wander larger than the sample noise: what is periodic is taken for wander otherwise.
    pub fn calm(&self) -> Self {
        let mut calm = *self;
        let small = self.small();
        for component in Component::ALL.into_iter().filter(|component| component.wanders()) {
            calm[component] = small[component];
        }
        calm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_component_has_a_place_of_its_own() {
        let mut noise = NoiseModel::even(0.0, 0.0);
        for (number, component) in Component::ALL.into_iter().enumerate() {
            assert_eq!(component.place(), number);
            noise[component] = number as f64 + 1.0;
        }
        assert!(Component::ALL.iter().enumerate().all(|(number, component)| noise[*component] == number as f64 + 1.0));
    }

    #[test]
    fn a_small_noise_hides_no_effect_but_what_nobody_saw() {
        let mut noise = NoiseModel::even(5.0, 900.0);
        Component::ALL.into_iter().for_each(|component| noise[component] = 100.0);
        let small = noise.small();
        assert_eq!(small[Component::Initial(2)], 100.0);
        assert_eq!((small[Component::Walk], small[Component::Position], small.sample), (0.05, 5.0, 5.0));
        let calm = noise.calm();
        assert_eq!((calm[Component::Position], calm[Component::Wander], calm[Component::Walk]), (100.0, 5.0, 0.05));
    }
}
