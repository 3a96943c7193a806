//! After power-on the electronics settle.
//!
//! Amplitude control, voltage references and dielectrics take minutes to reach their working point.
//! The bias decays with the time since power-on, alike at every temperature and on every start.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 3,
    name: "warm-up",
    summary: "After power-on the electronics settle, and the bias decays with the time since power-on.",
    equation: "ΔB = A·exp(−t_on/τ)",
    source: "Huang et al., Micromachines 2022, 13, 1054, Table 1; Tocchio et al. on start-up",
    parameters: &[
        Parameter {
            name: "amplitude_g",
            unit: "g",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.1,
            high: 0.1,
            typical: 140e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "tau_s",
            unit: "s",
            role: Role::Shape,
            start: 600.0,
            low: 5.0,
            high: 36_000.0,
            typical: 600.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::ELECTRONICS,
    needs: "recordings that begin at power-on",
};

/// ΔB = A·exp(−t_on/τ).
pub struct WarmUp;

impl<R: Real> Effect<R> for WarmUp {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn bias_g(&self, moment: &Moment<R>, &[amplitude_g, tau_s, ..]: &Coefficients<R>) -> R {
        if tau_s > R::ZERO { amplitude_g * (-(moment.now.power_on_s / tau_s)).exp() } else { R::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn it_settles_by_a_factor_e_in_ten_minutes() {
        for (power_on_s, worked_g) in [(0.0, 140e-6), (600.0, 51.503_122e-6)] {
            assert_near(Bench::power_on_s(power_on_s).bias_g(&WarmUp, &[140e-6, 600.0]), worked_g);
        }
    }

    #[test]
    fn without_a_time_constant_it_is_warm_at_once() {
        assert_eq!(Bench::REST.bias_g(&WarmUp, &[140e-6, 0.0]), 0.0);
    }
}
