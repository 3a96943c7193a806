//! The drive follows the supply.
//!
//! Drive amplitude and electrostatic spring move with the rail; what the pair does not cancel is a
//! bias in proportion.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, Signal, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 6,
    name: "supply-voltage",
    summary: "Drive amplitude and electrostatic spring follow the supply voltage, and the bias with them.",
    equation: "ΔB = K·(V − V0)",
    source: "Comi et al., JMEMS 2010",
    parameters: &[
        Parameter {
            name: "bias_g_per_v",
            unit: "g/V",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.1,
            high: 0.1,
            typical: 1e-3,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "nominal_v",
            unit: "V",
            role: Role::Origin,
            start: 5.0,
            low: 0.0,
            high: 50.0,
            typical: 5.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: Some("supply_v"),
    needs_frequency: false,
    sum_response: SumResponse::ELECTRONICS,
    needs: "a supply_v column that varies by a few per cent",
};

/// ΔB = K·(V − V0).
pub struct SupplyVoltage;

impl<R: Real> Effect<R> for SupplyVoltage {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn signal(&self) -> Signal {
        Signal::Channel
    }

    fn bias_g(&self, moment: &Moment<R>, &[k, nominal_v, ..]: &Coefficients<R>) -> R {
        k * (moment.channel - nominal_v)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn a_quarter_volt_more_is_250_ug() {
        let bench = Bench { channel: 5.25, ..Bench::REST };
        assert_near(bench.bias_g(&SupplyVoltage, &[1e-3, 5.0]), 250e-6);
    }
}
