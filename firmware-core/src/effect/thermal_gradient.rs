//! While heat flows through the package, one resonator is warmer than the other.
//!
//! The pair cancels what both share, not what they don't: one millikelvin between them is about 30
//! times worse than one millikelvin on both. The difference follows the temperature's rate, so the
//! bias does too, alike at every temperature; the mean frequency does not notice.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::memory::Memory;
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 2,
    name: "thermal-gradient",
    summary: "While the temperature changes, one resonator is warmer than the other, and the bias shifts in proportion to the rate.",
    equation: "ΔB = K·dT/dt, the rate smoothed over τ",
    source: "Kim & Jung, Sensors 2025, 25, 6131",
    parameters: &[
        Parameter {
            name: "bias_g_per_c_per_s",
            unit: "g/(°C/s)",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.1,
            high: 0.1,
            typical: 6e-3,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "tau_s",
            unit: "s",
            role: Role::Shape,
            start: 5.0,
            low: 0.5,
            high: 300.0,
            typical: 5.0,
            sound_limit: SoundLimit::Low,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::GRADIENT,
    needs: "temperature ramps at two rates, where the bias has different slopes over temperature",
};

/// ΔB = K·dT/dt.
pub struct ThermalGradient;

impl<R: Real> Effect<R> for ThermalGradient {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn memory(&self, &[_, tau_s, ..]: &Coefficients<R>) -> Memory<R> {
        Memory::Lag { tau_s }
    }

    fn bias_g(&self, moment: &Moment<R>, &[k, tau_s, ..]: &Coefficients<R>) -> R {
        // The departure of a lag, over its time constant, is the smoothed rate.
        if tau_s > R::ZERO { k * moment.departure / tau_s } else { R::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near, padded};
    use super::*;

    #[test]
    fn one_degree_a_minute_is_100_ug() {
        // A lag of 5 s behind 1 °C/min settles at a twelfth of a degree.
        let coefficients = [6e-3, 5.0];
        let bench = Bench { departure: 1.0 / 12.0, ..Bench::REST };
        assert_near(bench.bias_g(&ThermalGradient, &coefficients), 100e-6);
        assert_eq!(ThermalGradient.memory(&padded(&coefficients)), Memory::Lag { tau_s: 5.0 });
        assert_eq!(Bench::REST.bias_g(&ThermalGradient, &[6e-3, 0.0]), 0.0, "without a time constant there is no rate");
    }
}
