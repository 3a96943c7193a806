//! Whether a coefficient was stopped by the bound of what makes physical sense.

use firmware_core::effect::{About, Parameter, Role};
use std::ops::RangeInclusive;

/// A shape this close to its bound, as a ratio, was stopped by it.
pub const AT_BOUND: f64 = 1.05;

/// The first coefficient that was stopped by its bound, or sits where nothing was measured (`range_c`, °C): then the effect
/// is something else. An amplitude at its bound is a large effect, and a formula may have a sound limit.
#[must_use]
pub fn at_bound(about: &'static About, values: &[f64], range_c: &RangeInclusive<f64>) -> Option<&'static Parameter> {
    let is_at_bound = |(parameter, value): &(&'static Parameter, &f64)| match parameter.role {
        Role::Shape => {
            (**value < parameter.low * AT_BOUND && !parameter.sound_limit.is_low())
                || (**value * AT_BOUND > parameter.high && !parameter.sound_limit.is_high())
        }
        Role::Location if parameter.unit == "°C" => {
            let reach_c = reach_c_per_g(about, values);
            **value + reach_c < *range_c.start() || **value - reach_c > *range_c.end()
        }
        Role::Location | Role::Amplitude | Role::Origin => false,
    };
    about.parameters.iter().zip(values).find(is_at_bound).map(|(parameter, _)| parameter)
}

/// How far 1 g moves the place where an effect sits, °C.
fn reach_c_per_g(about: &About, values: &[f64]) -> f64 {
    let pairs = about.parameters.iter().zip(values);
    pairs.filter(|(parameter, _)| parameter.unit == "°C/g").map(|(_, value)| value.abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::effect;

    fn named(name: &str, values: &[f64]) -> Option<&'static str> {
        at_bound(effect::about(name).unwrap(), values, &(-10.0..=50.0)).map(|parameter| parameter.name)
    }

    fn is_at_bound(name: &str, values: &[f64]) -> bool {
        named(name, values).is_some()
    }

    #[test]
    fn what_was_stopped_is_named() {
        assert_eq!(named("warm-up", &[1e-4, 5.2]), Some("tau_s"));
        assert_eq!(named("warm-up", &[1e-4, 600.0]), None);
    }

    #[test]
    fn a_shape_at_its_bound_was_stopped_unless_the_formula_has_a_sound_limit_there() {
        // From 5 s to 36,000 s; a gradient from 0.5 s, where the rate is not smoothed at all, to 300 s.
        assert!(is_at_bound("warm-up", &[1e-4, 5.2]) && is_at_bound("warm-up", &[1e-4, 35_000.0]));
        assert!(!is_at_bound("warm-up", &[1e-4, 5.3]) && !is_at_bound("warm-up", &[1e-4, 34_000.0]));
        assert!(!is_at_bound("thermal-gradient", &[1e-3, 0.5]) && is_at_bound("thermal-gradient", &[1e-3, 299.0]));
        // An amplitude at its bound is a large effect.
        assert!(!is_at_bound("warm-up", &[0.1, 600.0]));
    }

    #[test]
    fn a_place_is_at_bound_where_nothing_was_measured_that_its_shift_could_reach() {
        assert!(
            !is_at_bound("mode-crossing", &[1e-4, 2.0, 49.0, 0.0])
                && is_at_bound("mode-crossing", &[1e-4, 2.0, 51.0, 0.0])
        );
        assert!(
            !is_at_bound("mode-crossing", &[1e-4, 2.0, 51.0, -3.0])
                && is_at_bound("mode-crossing", &[1e-4, 2.0, 54.0, 3.0])
        );
        assert!(
            is_at_bound("mode-crossing", &[1e-4, 2.0, -14.0, 3.0])
                && !is_at_bound("mode-crossing", &[1e-4, 2.0, -12.0, 3.0])
        );
    }
}
