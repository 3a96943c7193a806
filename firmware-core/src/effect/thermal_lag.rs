//! The thermometer and the resonators do not sit in the same place.
//!
//! Heat reaches one later than the other, so while the temperature moves the map is entered with the
//! wrong temperature. The residual opens into a loop whose width grows with the ramp rate and with
//! the local slope of the bias over temperature; it closes when the rate is zero.

use super::{About, Coefficients, Disturbance, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::memory::Memory;
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 1,
    name: "thermal-lag",
    summary: "The resonators follow the thermometer late, so during a temperature change the map is entered with the wrong temperature.",
    equation: "τ·dTr/dt = T − Tr; the map is evaluated at Tr",
    source: "Guo et al., Micromachines 2023, 14, 161",
    parameters: &[Parameter {
        name: "tau_s",
        unit: "s",
        role: Role::Shape,
        start: 35.0,
        low: 0.5,
        high: 3600.0,
        typical: 35.0,
        sound_limit: SoundLimit::Neither,
        follows_reference: 0,
    }],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::Predicted,
    needs: "temperature ramps, best at two rates and in both directions",
};

/// τ·dTr/dt = T − Tr.
pub struct ThermalLag;

impl<R: Real> Effect<R> for ThermalLag {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn memory(&self, &[tau_s, ..]: &Coefficients<R>) -> Memory<R> {
        Memory::Lag { tau_s }
    }

    fn disturb(&self, moment: &Moment<R>, _: &Coefficients<R>) -> Disturbance<R> {
        Disturbance::of_temperature(-moment.departure)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near, padded};
    use super::*;

    #[test]
    fn the_resonators_are_cooler_while_the_thermometer_rises() {
        let bench = Bench { departure: 0.5, ..Bench::REST };
        assert_near(bench.disturbance(&ThermalLag, &[35.0]).temperature_c, -0.5);
        assert_eq!(ThermalLag.memory(&padded(&[35.0])), Memory::Lag { tau_s: 35.0 });
    }
}
