//! The noise as an answer reports it, and back: the one place where the units are changed.

use super::components::{Component, NoiseModel};
use crate::diagnose::answer::Noise;

/// A walk's unit is µg/√s here, and µg/√h in an answer.
const SQRT_S_PER_SQRT_H: f64 = 60.0;

/// The residual's noise, µg, as an answer reports it.
pub fn reported(noise: &NoiseModel) -> Noise {
    Noise {
        sample_ug: noise.sample,
        flicker_ug: noise[Component::Flicker],
        wander_ug: noise[Component::Wander],
        walk_ug_per_sqrt_h: noise[Component::Walk] * SQRT_S_PER_SQRT_H,
        node_ug: noise[Component::Node],
        position_ug: noise[Component::Position],
        pose_ug: noise[Component::Pose],
        mounting_ug: noise[Component::Mounting],
        turn_ug: noise[Component::Turn],
        run_ug: noise[Component::Run],
    }
}

/// The noise that an answer reports, where the reading changes by `per_c` µg/°C. Of initial states it says nothing: they
/// are taken to be as large as a sample's noise.
pub fn from_reported(found: &Noise, per_c: f64) -> NoiseModel {
    let mut noise = NoiseModel::even(found.sample_ug, per_c);
    for (component, sigma) in [
        (Component::Run, found.run_ug),
        (Component::Mounting, found.mounting_ug),
        (Component::Position, found.position_ug),
        (Component::Pose, found.pose_ug),
        (Component::Turn, found.turn_ug),
        (Component::Node, found.node_ug),
        (Component::Flicker, found.flicker_ug),
        (Component::Wander, found.wander_ug),
        (Component::Walk, found.walk_ug_per_sqrt_h / SQRT_S_PER_SQRT_H),
    ] {
        noise[component] = sigma;
    }
    noise
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_reported_comes_back() {
        let mut noise = NoiseModel::even(5.0, 900.0);
        for (number, component) in Component::ALL.into_iter().enumerate() {
            if !matches!(component, Component::Initial(_)) {
                noise[component] = 10.0 + number as f64;
            }
        }
        assert_eq!(from_reported(&reported(&noise), 900.0), noise);
        assert_eq!(reported(&noise).walk_ug_per_sqrt_h, 16.0 * 60.0);
    }
}
