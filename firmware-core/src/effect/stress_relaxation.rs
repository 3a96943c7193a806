//! The die attach creeps after every change of temperature.
//!
//! Glue and solder take up thermal stress at once and give it back over minutes to days. Each change
//! leaves a bias that decays, in the direction opposite to the change; switching off does not reset it.
//!
//! A rate smoothed over a time constant, as of `thermal-gradient`, is the same formula: with the time
//! constants of both within a few minutes, nothing tells them apart. Their physics lie apart: heat
//! crosses a package in seconds, glue creeps for hours. Creep that is faster when hot (Arrhenius) is
//! not in the formula.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::memory::Memory;
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 7,
    name: "stress-relaxation",
    summary: "The die attach takes up thermal stress and creeps, so each temperature change leaves a bias that decays over hours.",
    equation: "dq/dt = dT/dt − q/τ; ΔB = b·q",
    source: "Moreira et al., INERTIAL 2020; Materials 2017, 10, 1077",
    parameters: &[
        Parameter {
            name: "bias_g_per_c",
            unit: "g/°C",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.01,
            high: 0.01,
            typical: 5e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "tau_s",
            unit: "s",
            role: Role::Shape,
            start: 6000.0,
            low: 300.0,
            high: 1e6,
            typical: 6000.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "hours of soak after large temperature steps, best at two temperatures",
};

/// dq/dt = dT/dt − q/τ; ΔB = b·q.
pub struct StressRelaxation;

impl<R: Real> Effect<R> for StressRelaxation {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn memory(&self, &[_, tau_s, ..]: &Coefficients<R>) -> Memory<R> {
        Memory::Lag { tau_s }
    }

    fn bias_g(&self, moment: &Moment<R>, &[b, ..]: &Coefficients<R>) -> R {
        b * moment.departure
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near, padded};
    use super::*;

    #[test]
    fn a_fresh_step_of_35_c_is_175_ug_and_remembered_for_the_time_constant() {
        let coefficients = [5e-6, 6000.0];
        let fresh = Bench { departure: 35.0, ..Bench::REST };
        assert_near(fresh.bias_g(&StressRelaxation, &coefficients), 175e-6);
        assert_eq!(StressRelaxation.memory(&padded(&coefficients)), Memory::Lag { tau_s: 6000.0 });
    }
}
