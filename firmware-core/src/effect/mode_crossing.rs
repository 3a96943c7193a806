//! At one frequency a resonator meets another mode of the structure.
//!
//! Two modes that come close push each other apart, so over temperature the bias shows a narrow
//! dispersive feature: up on one side, down on the other. It sits at a fixed frequency of one
//! resonator; acceleration moves that frequency too, and the feature appears at another temperature,
//! 17 °C per g where a resonator follows −2.4 Hz/°C and 42 Hz/g. Which of the two resonators it is
//! decides the sign.
//!
//! With nodes some 20 °C apart it looks like any bend of the thermometer's scale; a slow ramp shows it.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 16,
    name: "mode-crossing",
    summary: "At one temperature a resonator meets another mode of the structure, which bends the bias up on one side and down on the other.",
    equation: "ΔB = A·2xw/(x² + w²), x = T − Tx − s·a",
    source: "coupled-mode theory; activity dips of quartz resonators",
    parameters: &[
        Parameter {
            name: "amplitude_g",
            unit: "g",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.1,
            high: 0.1,
            typical: 300e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "width_c",
            unit: "°C",
            role: Role::Shape,
            start: 2.0,
            low: 0.1,
            high: 20.0,
            typical: 2.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
        Parameter {
            name: "crossing_c",
            unit: "°C",
            role: Role::Location,
            start: 25.0,
            low: -60.0,
            high: 130.0,
            typical: 25.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
        Parameter {
            name: "shift_c_per_g",
            unit: "°C/g",
            role: Role::Location,
            start: 0.0,
            low: -150.0,
            high: 150.0,
            typical: 0.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: -1,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "slow temperature ramps with dense temperatures, repeated at two levels of acceleration",
};

/// ΔB = A·2xw/(x² + w²), x = T − Tx − s·a.
pub struct ModeCrossing;

impl<R: Real> Effect<R> for ModeCrossing {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn bias_g(&self, moment: &Moment<R>, &[amplitude_g, width_c, crossing_c, shift, ..]: &Coefficients<R>) -> R {
        if width_c > R::ZERO {
            let away = (moment.now.temperature_c - crossing_c - shift * moment.level_g) / width_c;
            amplitude_g * ((away + away) / (R::ONE + away * away))
        } else {
            R::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn the_extremes_are_one_width_beside_the_crossing() {
        for (temperature_c, worked_g) in [(28.0, -300e-6), (30.0, 0.0), (32.0, 300e-6), (34.0, 240e-6)] {
            let bench = Bench::temperature_c(temperature_c);
            assert_near(bench.bias_g(&ModeCrossing, &[300e-6, 2.0, 30.0, 17.0]), worked_g);
        }
    }

    #[test]
    fn a_crossing_without_a_width_adds_nothing_at_its_middle_either() {
        assert_eq!(Bench::temperature_c(30.0).bias_g(&ModeCrossing, &[300e-6, 0.0, 30.0, 17.0]), 0.0);
    }

    #[test]
    fn one_g_moves_the_crossing_by_the_shift() {
        let bench = Bench { level_g: 1.0, ..Bench::temperature_c(49.0) };
        assert_near(bench.bias_g(&ModeCrossing, &[300e-6, 2.0, 30.0, 17.0]), 300e-6);
    }
}
