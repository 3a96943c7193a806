//! The two resonators answer acceleration with slightly different strength.
//!
//! What is left of their even nonlinearities after subtraction grows with the square of the
//! acceleration: the coefficient K2 of IEEE 1293.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 5,
    name: "second-order",
    summary: "The resonators' force sensitivities differ, which leaves a term in the square of the acceleration.",
    equation: "ΔB = K2·a²",
    source: "IEEE Std 1293, K2; Qiu et al. on fork mismatch",
    parameters: &[Parameter {
        name: "k2_g_per_g2",
        unit: "g/g²",
        role: Role::Amplitude,
        start: 0.0,
        low: -0.01,
        high: 0.01,
        typical: 10e-6,
        sound_limit: SoundLimit::Neither,
        follows_reference: -1,
    }],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "five or more levels of acceleration, as in a tumble",
};

/// ΔB = K2·a².
pub struct SecondOrder;

impl<R: Real> Effect<R> for SecondOrder {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn bias_g(&self, moment: &Moment<R>, &[k2, ..]: &Coefficients<R>) -> R {
        k2 * moment.level_g * moment.level_g
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn both_ends_read_off_in_the_same_direction() {
        let at = |level_g| Bench { level_g, ..Bench::REST }.bias_g(&SecondOrder, &[10e-6]);
        assert_near(at(3.0), 90e-6);
        assert_near(at(-3.0), 90e-6);
    }
}
