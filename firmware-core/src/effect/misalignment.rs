//! The input axis does not point where the case says.
//!
//! Turned by a small angle ψ towards the pendulous axis, the sensor reads a·cos ψ + a_p·sin ψ. The
//! cosine is a constant of the scale factor, which the calibration takes up; the sine is the angle.
//! Package and mount bend with temperature, so the angle may move.
//!
//! It takes the cross acceleration as a channel. In a field of 1 g its size follows from the reading,
//! √(1 − a²), but not its sign: the sensor can't know to which side it lies, and what follows from the
//! reading alone the calibration knows already. A constant angle can't be told from the linear part of
//! `cross-axis`, nor in one mounting from an error of the turntable's zero: turn the sensor by 180°
//! about its input axis.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, Signal, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 12,
    name: "misalignment",
    summary: "The input axis is tilted against the case, so a share of the cross acceleration is read as input.",
    equation: "ΔB = (ψ + ψ_T·(T − 25 °C))·a_p",
    source: "IEEE Std 1293, misalignment δ and its temperature sensitivity",
    parameters: &[
        Parameter {
            name: "angle_rad",
            unit: "rad",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.1,
            high: 0.1,
            typical: 100e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "angle_rad_per_c",
            unit: "rad/°C",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.001,
            high: 0.001,
            typical: 1e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
    ],
    channel: Some("cross_g"),
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "a cross_g column, and a tumble in two mountings turned by 180° about the input axis",
};

/// ΔB = (ψ + ψ_T·(T − 25 °C))·a_p.
pub struct Misalignment;

impl<R: Real> Effect<R> for Misalignment {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn signal(&self) -> Signal {
        Signal::Channel
    }

    fn bias_g(&self, moment: &Moment<R>, &[angle, angle_per_c, ..]: &Coefficients<R>) -> R {
        let warmer_c = moment.now.temperature_c - R::from_f32(25.0);
        (angle + angle_per_c * warmer_c) * moment.channel
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn lying_level_it_reads_the_angle_with_the_sign_of_the_side() {
        for (cross_g, worked_g) in [(1.0, 130e-6), (0.0, 0.0), (-1.0, -130e-6)] {
            let bench = Bench { channel: cross_g, ..Bench::temperature_c(55.0) };
            assert_near(bench.bias_g(&Misalignment, &[100e-6, 1e-6]), worked_g);
        }
    }

    #[test]
    fn a_degree_is_read_as_a_turn_of_the_axis_but_for_the_scale_factor() {
        let (angle, tumble) = (libm::sin(0.01), 0.7);
        let (input_g, cross_g) = (libm::sin(tumble), libm::cos(tumble));
        let bench = Bench { channel: cross_g, level_g: input_g, ..Bench::REST };
        let turned_g = libm::sin(tumble + 0.01);
        let scaled_g = input_g * libm::cos(0.01);
        assert!((scaled_g + bench.bias_g(&Misalignment, &[angle, 0.0]) - turned_g).abs() < 1e-15);
    }
}
