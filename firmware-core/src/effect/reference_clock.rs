//! The counter's clock is not as fast as it says.
//!
//! A frequency is counted against a crystal, and the crystal ages. Both frequencies are off by the same
//! fraction, and so is their difference: 1 ppm in the scale factor and, because the difference at 0 g
//! is not zero, about 1 µg in the bias. A constant error and one that follows the temperature are part
//! of any calibration; what is left is the drift.
//!
//! `scale-factor-aging` differs from it by that 1 µg per ppm only. The sum of the frequencies, off by 82 mHz
//! per ppm, tells them apart at once.

use super::{About, Coefficients, Disturbance, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 20,
    name: "reference-clock",
    summary: "The counter's crystal ages, so all frequencies and their difference drift by the same fraction.",
    equation: "Δf seen = Δf·(1 − y), y = D·t",
    source: "crystal oscillator data sheets, ageing; IEEE Std 1293, scale-factor error",
    parameters: &[Parameter {
        name: "rate_ppm_per_day",
        unit: "ppm/day",
        role: Role::Amplitude,
        start: 0.0,
        low: -100.0,
        high: 100.0,
        typical: 3e-3,
        sound_limit: SoundLimit::Neither,
        follows_reference: 0,
    }],
    channel: None,
    needs_frequency: true,
    sum_response: SumResponse::Predicted,
    needs: "an age_days column, runs over months at more than one level of acceleration, and the sum of the frequencies",
};

/// Δf seen = Δf·(1 − y), y = D·t.
pub struct ReferenceClock;

impl<R: Real> Effect<R> for ReferenceClock {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn needs_age(&self) -> bool {
        true
    }

    fn disturb(&self, moment: &Moment<R>, &[rate_ppm_per_day, ..]: &Coefficients<R>) -> Disturbance<R> {
        let fast_ppm = rate_ppm_per_day * moment.now.age_days;
        // Of the seen difference instead of the true one: the same to y², a million times less.
        Disturbance::of_delta_f(-(moment.now.delta_f_hz * (fast_ppm / R::from_f32(1e6))))
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn one_ppm_is_76_microhertz_at_0_g() {
        let disturbance = Bench::age_days(1000.0).disturbance(&ReferenceClock, &[0.001]);
        assert_near(disturbance.delta_f_hz, -76e-6);
        assert_near(disturbance.temperature_c, 0.0);
    }
}
