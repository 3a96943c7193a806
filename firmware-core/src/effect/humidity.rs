//! Moisture swells package and board.
//!
//! Plastic and board take up water over hours to days and swell; what the pair does not cancel of that
//! stress is a bias in proportion to the moisture inside, which follows the humidity of the air late.
//! Hermetic parts have none of it. At the first sample the moisture is taken to be in balance with the
//! air: nobody knows better.
//!
//! Within a campaign of a few days it looks like `aging`, until the humidity turns back.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, Signal, SoundLimit, SumResponse};
use crate::memory::Memory;
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 15,
    name: "humidity",
    summary: "Moisture that package and board take up over hours swells them, and the bias follows.",
    equation: "τ·dh/dt = H − h; ΔB = K·(h − h0)",
    source: "JMEMS-2021-0212 on humidity; Analog Devices, EngineerZone on the ADXL343",
    parameters: &[
        Parameter {
            name: "bias_g_per_pct",
            unit: "g/%",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.01,
            high: 0.01,
            typical: 5e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "tau_h",
            unit: "h",
            role: Role::Shape,
            start: 20.0,
            low: 0.5,
            high: 1000.0,
            typical: 20.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
        Parameter {
            name: "nominal_pct",
            unit: "%",
            role: Role::Origin,
            start: 40.0,
            low: 0.0,
            high: 100.0,
            typical: 40.0,
            sound_limit: SoundLimit::Neither,
            follows_reference: 0,
        },
    ],
    channel: Some("humidity_pct"),
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "a humidity_pct column with steps of tens of per cent, each held for days",
};

/// τ·dh/dt = H − h; ΔB = K·(h − h0).
pub struct Humidity;

impl<R: Real> Effect<R> for Humidity {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn signal(&self) -> Signal {
        Signal::Channel
    }

    fn memory(&self, &[_, tau_h, ..]: &Coefficients<R>) -> Memory<R> {
        Memory::Lag { tau_s: tau_h * R::from_f32(3600.0) }
    }

    fn bias_g(&self, moment: &Moment<R>, &[k, _, nominal_pct, ..]: &Coefficients<R>) -> R {
        k * (moment.channel - nominal_pct - moment.departure)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near, padded};
    use super::*;

    #[test]
    fn air_at_85_percent_acts_as_far_as_the_moisture_has_followed() {
        let coefficients = [5e-6, 20.0, 40.0];
        for (departure, worked_g) in [(45.0, 0.0), (20.0, 125e-6), (0.0, 225e-6)] {
            let bench = Bench { channel: 85.0, departure, ..Bench::REST };
            assert_near(bench.bias_g(&Humidity, &coefficients), worked_g);
        }
        assert_eq!(Humidity.memory(&padded(&coefficients)), Memory::Lag { tau_s: 72_000.0 });
    }
}
