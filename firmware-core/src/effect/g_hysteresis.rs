//! The flexure remembers the acceleration before.
//!
//! An anelastic suspension gives way a little more while it is loaded and comes back over minutes. After
//! 1 g the sensor reads 0 g a little too high, and forgets.
//!
//! In a fixed order of positions every 0 g follows the same neighbour, and this looks like a
//! `misalignment`; a random order tells them apart.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, Signal, SoundLimit, SumResponse};
use crate::memory::Memory;
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 19,
    name: "g-hysteresis",
    summary: "The suspension yields under load and comes back over minutes, so a reading depends on the acceleration before it.",
    equation: "τ·dz/dt = a − z; ΔB = K·(z − a)",
    source: "IEEE Std 1293, hysteresis; anelastic relaxation, sizes are engineering estimates",
    parameters: &[
        Parameter {
            name: "bias_g_per_g",
            unit: "g/g",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.01,
            high: 0.01,
            typical: 20e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
        Parameter {
            name: "tau_s",
            unit: "s",
            role: Role::Shape,
            start: 200.0,
            low: 2.0,
            high: 10_000.0,
            typical: 200.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::GRADIENT,
    needs: "positions in random order, with minutes of rest after large changes",
};

/// τ·dz/dt = a − z; ΔB = K·(z − a).
pub struct GHysteresis;

impl<R: Real> Effect<R> for GHysteresis {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn signal(&self) -> Signal {
        Signal::Level
    }

    fn memory(&self, &[_, tau_s, ..]: &Coefficients<R>) -> Memory<R> {
        Memory::Lag { tau_s }
    }

    fn bias_g(&self, moment: &Moment<R>, &[k, ..]: &Coefficients<R>) -> R {
        -(k * moment.departure)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near, padded};
    use super::*;

    #[test]
    fn right_after_1_g_the_level_reads_20_ug_too_high() {
        let coefficients = [20e-6, 200.0];
        let back_from_1_g = Bench { departure: -1.0, ..Bench::REST };
        assert_near(back_from_1_g.bias_g(&GHysteresis, &coefficients), 20e-6);
        assert_eq!(GHysteresis.memory(&padded(&coefficients)), Memory::Lag { tau_s: 200.0 });
    }
}
