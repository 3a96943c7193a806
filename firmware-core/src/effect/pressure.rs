//! The air bends the package's lid.
//!
//! Lid and die bend together, and what the pair does not cancel of that stress is a bias in proportion.
//! It follows the weather (±20 hPa) and the altitude.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, Signal, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 14,
    name: "pressure",
    summary: "Air pressure bends the package's lid, and the bias follows weather and altitude.",
    equation: "ΔB = K·(p − p0)",
    source: "IEEE Std 1293, pressure sensitivity; sizes are engineering estimates",
    parameters: &[
        Parameter {
            name: "bias_g_per_hpa",
            unit: "g/hPa",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.001,
            high: 0.001,
            typical: 0.3e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "nominal_pa",
            unit: "Pa",
            role: Role::Origin,
            start: 101_325.0,
            low: 0.0,
            high: 1e7,
            typical: 101_325.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: Some("pressure_pa"),
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "a pressure_pa column that varies by some tens of hPa, as in a bell jar",
};

/// ΔB = K·(p − p0).
pub struct Pressure;

impl<R: Real> Effect<R> for Pressure {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn signal(&self) -> Signal {
        Signal::Channel
    }

    fn bias_g(&self, moment: &Moment<R>, &[k, nominal_pa, ..]: &Coefficients<R>) -> R {
        let above_hpa = (moment.channel - nominal_pa) / R::from_f32(100.0);
        k * above_hpa
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn half_an_atmosphere_less_is_150_ug_less() {
        let bench = Bench { channel: 51_325.0, ..Bench::REST };
        assert_near(bench.bias_g(&Pressure, &[0.3e-6, 101_325.0]), -150e-6);
    }
}
