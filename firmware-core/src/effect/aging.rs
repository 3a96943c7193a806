//! The bias moves with the calendar.
//!
//! Adhesives relax, cure and give off gas. The drift begins at some rate and slows down, and how it
//! slows down depends on what ages. One family holds the usual laws: its rate falls as
//! (1 + t/(n·τ))^−n. Order n = 1 is the logarithm of relaxing adhesives, a large order the
//! exponential of curing that ends, n = ½ a diffusion (√t), and a time constant τ beyond the data a
//! straight line. In the first months they look alike: the form is known only after about 2·τ.
//!
//! Within a campaign of few days this is a constant and not to be told from the bias; an offset that
//! is new at every power-on looks like it until there are more runs than laws.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 8,
    name: "aging",
    summary: "The bias drifts with the sensor's calendar age: steadily, ever more slowly, or towards an end.",
    equation: "dB/dt = D·(1 + t/(n·τ))^−n: n = 1 gives D·τ·ln(1 + t/τ), n → ∞ D·τ·(1 − exp(−t/τ)), τ → ∞ D·t",
    source: "Peng et al., IEEE Sensors Journal 2023, 10.1109/jsen.2022.3222006; MIL-PRF-55310 (logarithm)",
    parameters: &[
        Parameter {
            name: "rate_g_per_day",
            unit: "g/day",
            role: Role::Amplitude,
            start: 0.0,
            low: -0.01,
            high: 0.01,
            typical: 2e-6,
            sound_limit: SoundLimit::Neither,
            follows_reference: 1,
        },
        Parameter {
            name: "tau_days",
            unit: "day",
            role: Role::Shape,
            start: 30.0,
            low: 0.05,
            high: 1e5,
            typical: 30.0,
            sound_limit: SoundLimit::High,
            follows_reference: 0,
        },
        Parameter {
            name: "order",
            unit: "",
            role: Role::Shape,
            start: 1.0,
            low: 0.5,
            high: 100.0,
            typical: 1.0,
            sound_limit: SoundLimit::Both,
            follows_reference: 0,
        },
    ],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "an age_days column, and runs over months at logarithmic intervals",
};

/// dB/dt = D·(1 + t/(n·τ))^−n.
pub struct Aging;

impl<R: Real> Effect<R> for Aging {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn needs_age(&self) -> bool {
        true
    }

    fn bias_g(&self, moment: &Moment<R>, &[rate, tau_days, order, ..]: &Coefficients<R>) -> R {
        if tau_days > R::ZERO && order > R::ZERO {
            let scale_days = order * tau_days;
            let folds = (moment.now.age_days / scale_days).ln_1p();
            rate * (scale_days * (folds * growth((R::ONE - order) * folds)))
        } else {
            R::ZERO
        }
    }
}

/// (eᶻ − 1)/z, which is 1 at z = 0: where the order is 1, the integral of the power is the logarithm.
fn growth<R: Real>(z: R) -> R {
    if z == R::ZERO { R::ONE } else { z.exp_m1() / z }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn the_family_holds_the_usual_laws() {
        let aged = |tau_days, order| Bench::age_days(400.0).bias_g(&Aging, &[1e-6, tau_days, order]);
        assert_near(aged(30.0, 1.0), 30e-6 * libm::log(1.0 + 400.0 / 30.0));
        // Orders ½ and 2 have integrals without logarithms.
        assert_near(aged(30.0, 0.5), 30e-6 * (libm::sqrt(1.0 + 800.0 / 30.0) - 1.0));
        assert_near(aged(30.0, 2.0), 400e-6 / (1.0 + 400.0 / 60.0));
        assert!((aged(30.0, 1e6) - 30e-6 * (1.0 - libm::exp(-400.0 / 30.0))).abs() < 1e-10);
        assert_near(aged(1e9, 1.0), 400e-6);
    }

    #[test]
    fn without_a_time_or_an_order_nothing_ages() {
        for [tau_days, order] in [[0.0, 1.0], [30.0, 0.0]] {
            assert_eq!(Bench::REST.bias_g(&Aging, &[1e-6, tau_days, order]), 0.0);
            assert_eq!(Bench::age_days(400.0).bias_g(&Aging, &[1e-6, tau_days, order]), 0.0);
        }
    }

    #[test]
    fn nothing_jumps_where_the_order_passes_1() {
        let aged = |order| Bench::age_days(400.0).bias_g(&Aging, &[1e-6, 30.0, order]);
        assert!((aged(1.0 + 1e-12) - aged(1.0)).abs() < 1e-15 && (aged(1.0 - 1e-12) - aged(1.0)).abs() < 1e-15);
    }
}
