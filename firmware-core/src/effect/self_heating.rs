//! The resonators warm themselves, and the thermometer does not see it.
//!
//! Their drive dissipates some milliwatts on the die, the electronics more beside it. After power-on the
//! resonators rise above the thermometer over minutes. Once settled the rise is part of the
//! calibration; before that the map is entered with a temperature that is too high. A start soon after
//! power-off begins warm, which the time since power-on does not tell.
//!
//! `warm-up` of the electronics has the same course. It is alike at every temperature; this follows the
//! local slope of the bias over temperature, and moves the sum of the frequencies.

use super::{About, Coefficients, Disturbance, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 21,
    name: "self-heating",
    summary: "After power-on the resonators rise above the thermometer over minutes; until then they are cooler than the map expects.",
    equation: "Tr = T − ΔT·exp(−t_on/τ); the map is evaluated at Tr",
    source: "Huang et al., Micromachines 2022, 13, 1054, Table 1; IEEE Std 528, warm-up time",
    parameters: &[
        Parameter {
            name: "rise_c",
            unit: "°C",
            role: Role::Amplitude,
            start: 0.0,
            low: -20.0,
            high: 20.0,
            typical: 0.15,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
        Parameter {
            name: "tau_s",
            unit: "s",
            role: Role::Shape,
            start: 900.0,
            low: 5.0,
            high: 36_000.0,
            typical: 900.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::Predicted,
    needs: "recordings that begin at power-on from cold, at temperatures where the bias has different slopes",
};

/// Tr = T − ΔT·exp(−t_on/τ).
pub struct SelfHeating;

impl<R: Real> Effect<R> for SelfHeating {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn disturb(&self, moment: &Moment<R>, &[rise_c, tau_s, ..]: &Coefficients<R>) -> Disturbance<R> {
        if tau_s > R::ZERO {
            let missing_c = rise_c * (-(moment.now.power_on_s / tau_s)).exp();
            Disturbance::of_temperature(-missing_c)
        } else {
            Disturbance::NONE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn the_resonators_start_a_fifth_of_a_degree_too_cool() {
        for (power_on_s, worked_c) in [(0.0, -0.2), (900.0, -0.073_575_888), (9e4, -0.2 * libm::exp(-100.0))] {
            let disturbance = Bench::power_on_s(power_on_s).disturbance(&SelfHeating, &[0.2, 900.0]);
            assert_near(disturbance.temperature_c, worked_c);
        }
    }

    #[test]
    fn without_a_time_constant_there_is_nothing_to_wait_for() {
        assert_eq!(Bench::REST.disturbance(&SelfHeating, &[0.2, 0.0]).temperature_c, 0.0);
    }
}
