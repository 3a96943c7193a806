//! The value at a temperature depends on the side from which it was reached.
//!
//! Friction-like stress in die attach and package follows the temperature with a play: the branches
//! up and down differ even after a long soak, the width does not depend on the rate, and a larger
//! excursion wipes out the memory of smaller ones.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::memory::Memory;
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 4,
    name: "thermal-hysteresis",
    summary: "Package stress follows the temperature with a play, so the bias depends on whether a temperature was reached from below or from above.",
    equation: "ΔB = w·(z − T), z the play operator of T with half width r",
    source: "Prandtl–Ishlinskii model; ADXL354/355 data sheet on repeatability",
    parameters: &[
        Parameter {
            name: "bias_g_per_c",
            unit: "g/°C",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.01,
            high: 0.01,
            typical: 10e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "half_width_c",
            unit: "°C",
            role: Role::Shape,
            start: 10.0,
            low: 0.2,
            high: 60.0,
            typical: 10.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "the same temperatures reached from below and from above, each soaked",
};

/// ΔB = w·(z − T).
pub struct ThermalHysteresis;

impl<R: Real> Effect<R> for ThermalHysteresis {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn memory(&self, &[_, radius, ..]: &Coefficients<R>) -> Memory<R> {
        Memory::Play { radius }
    }

    fn bias_g(&self, moment: &Moment<R>, &[w, ..]: &Coefficients<R>) -> R {
        -(w * moment.departure)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near, padded};
    use super::*;

    #[test]
    fn from_below_it_reads_low_and_from_above_high() {
        let coefficients = [10e-6, 4.0];
        for (departure, worked_g) in [(4.0, -40e-6), (-4.0, 40e-6)] {
            let bench = Bench { departure, ..Bench::REST };
            assert_near(bench.bias_g(&ThermalHysteresis, &coefficients), worked_g);
        }
        assert_eq!(ThermalHysteresis.memory(&padded(&coefficients)), Memory::Play { radius: 4.0 });
    }
}
