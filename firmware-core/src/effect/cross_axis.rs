//! Acceleration along the pendulous axis leaks into the reading.
//!
//! The suspension is not infinitely stiff across the input axis: a share δ of the cross acceleration is
//! read as input, and the product of both axes as well (K_ip of IEEE 1293).
//!
//! δ alone is the same formula as a `misalignment` of the same angle, and no experiment tells them apart;
//! the product, seen as a sine of twice the angle of a tumble, does. The square of the cross
//! acceleration is not in the formula: in a field of 1 g it is 1 − a², which the calibration has
//! taken up.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, Signal, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 11,
    name: "cross-axis",
    summary: "Acceleration across the input axis leaks into the reading, by itself and multiplied by the input.",
    equation: "ΔB = δ·a_p + K_ip·a·a_p",
    source: "IEEE Std 1293, δ and K_ip; US patent 8,117,917",
    parameters: &[
        Parameter {
            name: "delta_g_per_g",
            unit: "g/g",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.1,
            high: 0.1,
            typical: 100e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "kip_g_per_g2",
            unit: "g/g²",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.01,
            high: 0.01,
            typical: 20e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: Some("cross_g"),
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "a cross_g column, and a tumble of eight or more positions in random order, best in two mountings",
};

/// ΔB = δ·a_p + K_ip·a·a_p.
pub struct CrossAxis;

impl<R: Real> Effect<R> for CrossAxis {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn signal(&self) -> Signal {
        Signal::Channel
    }

    fn bias_g(&self, moment: &Moment<R>, &[delta, kip, ..]: &Coefficients<R>) -> R {
        (delta + kip * moment.level_g) * moment.channel
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn a_tumble_shows_a_cosine_and_a_sine_of_twice_the_angle() {
        let root = libm::sqrt(0.5);
        for (input_g, cross_g, worked_g) in [(0.0, 1.0, 100e-6), (root, root, 80.710_678e-6), (1.0, 0.0, 0.0)] {
            let bench = Bench { channel: cross_g, level_g: input_g, ..Bench::REST };
            assert_near(bench.bias_g(&CrossAxis, &[100e-6, 20e-6]), worked_g);
        }
    }
}
