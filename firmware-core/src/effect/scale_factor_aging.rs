//! The scale factor moves with the calendar.
//!
//! Stress that relaxes in the frame changes the force on the resonators and their stiffness. The
//! residual is proportional to the acceleration and grows with the age; at 0 g there is none.
//!
//! A counter's clock that ages does the same within 1 µg per ppm (`reference-clock`); the sum of the
//! frequencies tells them apart.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 9,
    name: "scale-factor-aging",
    summary: "The scale factor drifts with the sensor's calendar age, so the residual grows with acceleration and age.",
    equation: "ΔB = D·t·a",
    source: "Peng et al., IEEE Sensors Journal 2023, 10.1109/jsen.2022.3222006",
    parameters: &[Parameter {
        name: "rate_ppm_per_day",
        unit: "ppm/day",
        role: Role::Amplitude,
        start: 0.0,
        low: -1000.0,
        high: 1000.0,
        typical: 1.0,
        sound_limit: SoundLimit::Neither,
        follows_reference: 0,
    }],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "an age_days column, and runs over months at more than one level of acceleration",
};

/// ΔB = D·t·a.
pub struct ScaleFactorAging;

impl<R: Real> Effect<R> for ScaleFactorAging {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn needs_age(&self) -> bool {
        true
    }

    fn bias_g(&self, moment: &Moment<R>, &[rate_ppm_per_day, ..]: &Coefficients<R>) -> R {
        let drift_ppm = rate_ppm_per_day * moment.now.age_days;
        moment.level_g * (drift_ppm / R::from_f32(1e6))
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn after_100_days_1_g_reads_100_ug_more_and_0_g_the_same() {
        let aged = |level_g| Bench { level_g, ..Bench::age_days(100.0) }.bias_g(&ScaleFactorAging, &[1.0]);
        assert_near(aged(1.0), 100e-6);
        assert_near(aged(-0.5), -50e-6);
        assert_near(aged(0.0), 0.0);
    }
}
