//! One instant with everything that an effect may look at, for the effects' unit tests.

use super::{Disturbance, Effect, Moment};
use crate::observe::Observation;
use crate::program::Program;
use protocol::limits::{MAX_CHANNELS, MAX_PARAMETERS};

#[derive(Clone, Copy)]
pub(super) struct Bench {
    pub now: Observation<f64>,
    pub departure: f64,
    pub channel: f64,
    pub level_g: f64,
}

impl Bench {
    /// 25 °C, 76 Hz, 0 g, new and just switched on.
    pub const REST: Self = Self {
        now: Observation {
            delta_f_offset_hz: 0.0,
            delta_f_hz: 76.0,
            temperature_offset_c: 0.0,
            temperature_c: 25.0,
            power_on_s: 0.0,
            age_days: 0.0,
            channels: [0.0; MAX_CHANNELS],
        },
        departure: 0.0,
        channel: 0.0,
        level_g: 0.0,
    };

    /// At rest, so long after power-on.
    pub const fn power_on_s(power_on_s: f64) -> Self {
        Self { now: Observation { power_on_s, ..Self::REST.now }, ..Self::REST }
    }

    /// At rest, so old.
    pub const fn age_days(age_days: f64) -> Self {
        Self { now: Observation { age_days, ..Self::REST.now }, ..Self::REST }
    }

    /// At rest but for the temperature.
    pub const fn temperature_c(temperature_c: f64) -> Self {
        Self { now: Observation { temperature_c, ..Self::REST.now }, ..Self::REST }
    }

    /// At rest but for the frequency difference.
    pub const fn delta_f_hz(delta_f_hz: f64) -> Self {
        Self { now: Observation { delta_f_hz, ..Self::REST.now }, ..Self::REST }
    }

    pub fn bias_g(&self, effect: &impl Effect<f64>, coefficients: &[f64]) -> f64 {
        effect.bias_g(&self.moment(&Program::NONE), &padded(coefficients))
    }

    pub fn disturbance(&self, effect: &impl Effect<f64>, coefficients: &[f64]) -> Disturbance<f64> {
        effect.disturb(&self.moment(&Program::NONE), &padded(coefficients))
    }

    pub const fn moment<'a>(&'a self, program: &'a Program) -> Moment<'a, f64> {
        let Self { now, departure, channel, level_g } = self;
        Moment { now, departure: *departure, channel: *channel, level_g: *level_g, program }
    }
}

/// Coefficients in the form that effects take.
pub(super) fn padded(coefficients: &[f64]) -> [f64; MAX_PARAMETERS] {
    let mut all = [0.0; MAX_PARAMETERS];
    all.iter_mut().zip(coefficients).for_each(|(slot, value)| *slot = *value);
    all
}

/// Asserts that two numbers agree to a millionth of the expected one.
#[track_caller]
pub(super) fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-6 * expected.abs(), "{found} instead of {expected}");
}
