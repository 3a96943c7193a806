//! What a user suspects and no catalogue has: an expression of what is measured.
//!
//! A supply that heats the die only while the temperature moves, a magnet beside the rig, a filter that nobody
//! remembers: the coupling is often seen in a plot long before it is understood. The expression says on what the
//! bias depends, the fit says how much. It travels in the calibration as a small program, see `program.rs`.
//!
//! Where the expression has no value (a division by zero, the root of a negative number, an overflow) it adds nothing.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::memory::Memory;
use crate::program::Input;
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 22,
    name: "expression",
    summary: "An effect of your own: the bias follows an expression of what is measured, such as supply_v * temperature_rate.",
    equation: "ΔB = A·e, with your own expression e; temperature_departure q = T − low-pass(T, τ), temperature_rate = q/τ",
    source: "you; see docs/adding-an-effect.md",
    parameters: &[
        Parameter {
            name: "amplitude_g",
            unit: "g per unit",
            role: Role::Amplitude,
            start: 0.0,
            low: -1e9,
            high: 1e9,
            typical: 0.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "tau_s",
            unit: "s",
            role: Role::Shape,
            start: 30.0,
            low: 1.0,
            high: 36_000.0,
            typical: 30.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "whatever the expression reads must vary, and not along with acceleration or temperature alone",
};

/// ΔB = A·e.
pub struct Expression;

impl<R: Real> Effect<R> for Expression {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn takes_program(&self) -> bool {
        true
    }

    fn memory(&self, &[_, tau_s, ..]: &Coefficients<R>) -> Memory<R> {
        Memory::Lag { tau_s }
    }

    fn bias_g(&self, moment: &Moment<R>, &[amplitude_g, tau_s, ..]: &Coefficients<R>) -> R {
        let bias_g = moment.program.evaluate(|input| measured(moment, tau_s, input)).map(|value| amplitude_g * value);
        bias_g.filter(|bias_g| bias_g.is_finite()).unwrap_or(R::ZERO)
    }
}

fn measured<R: Real>(moment: &Moment<R>, tau_s: R, input: Input) -> R {
    match input {
        Input::Temperature => moment.now.temperature_c,
        Input::Departure => moment.departure,
        Input::Rate if tau_s > R::ZERO => moment.departure / tau_s,
        Input::Rate => R::ZERO,
        Input::DeltaF => moment.now.delta_f_hz,
        Input::Level => moment.level_g,
        Input::PowerOn => moment.now.power_on_s,
        Input::Age => moment.now.age_days,
        Input::Channel(channel) => moment.now.channels.get(usize::from(channel)).copied().unwrap_or(R::ZERO),
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near, padded};
    use super::*;
    use crate::program::Program;

    fn bias_g(bench: &Bench, code: &[u8]) -> f64 {
        let program = Program::new(code).expect("it is sound");
        Expression.bias_g(&bench.moment(&program), &padded(&[2e-3, 35.0]))
    }

    #[test]
    fn every_input_is_what_its_name_says() {
        let mut bench = Bench { departure: 7.0, level_g: 0.5, ..Bench::REST };
        (bench.now.power_on_s, bench.now.age_days, bench.now.channels) =
            (600.0, 400.0, [1., 2., 3., 4., 5., 6., 7., 8.]);
        let inputs = [25.0, 7.0, 0.2, 76.0, 0.5, 600.0, 400.0];
        for (byte, value) in (1..).zip(inputs).chain((0x80..).zip(bench.now.channels)) {
            assert_near(bias_g(&bench, &[byte]), 2e-3 * value);
        }
    }

    #[test]
    fn without_a_time_constant_the_rate_is_zero() {
        // dT/dt + T.
        let program = Program::new(&[0x03, 0x01, 0x10]).expect("it is sound");
        assert_near(Expression.bias_g(&Bench::REST.moment(&program), &padded(&[2e-3, 0.0])), 2e-3 * 25.0);
    }

    #[test]
    fn where_it_has_no_value_it_adds_nothing() {
        // T/q at rest, and √(−T).
        for code in [[0x01, 0x02, 0x13].as_slice(), &[0x01, 0x20, 0x23]] {
            assert_eq!(bias_g(&Bench::REST, code).to_bits(), 0);
        }
    }
}
