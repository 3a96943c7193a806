//! Two resonators on one frame pull each other's frequency when they come close.
//!
//! Some energy of each reaches the other. Closer than the locking range they run as one and their
//! difference is zero; outside, the difference is smaller than it would be (Adler). The mean
//! frequency stays.
//!
//! Locked, the difference says nothing of the acceleration: anything within ± the range would read the
//! same. The correction then steers to the middle of what is possible, so counter noise about zero
//! can't throw the reading from one edge to the other. Away from the range this is a function of the
//! frequency difference that the network learns by itself; close to it, it is too steep for that.

use super::{About, Coefficients, Disturbance, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 17,
    name: "lock-in",
    summary: "Close to equal frequencies the resonators pull each other, until they run as one and the sensor is blind.",
    equation: "Δf = sgn(Δf0)·√(Δf0² − fL²), 0 within ±fL; undone by Δf0 = Δf·√(1 + fL²/(Δf² + (10 mHz)²))",
    source: "Adler, Proc. IRE 1946, 34, 351; Zhao et al., JMEMS 2019, 10.1109/JMEMS.2019.2908931",
    parameters: &[Parameter {
        name: "range_hz",
        unit: "Hz",
        role: Role::Shape,
        start: 2.0,
        low: 0.01,
        high: 50.0,
        typical: 2.0,
        sound_limit: SoundLimit::Neither,
        follows_reference: 0,
    }],
    channel: None,
    needs_frequency: true,
    sum_response: SumResponse::GRADIENT,
    needs: "many levels of acceleration on both sides of equal frequencies, as in a tumble of 24 positions",
};

/// Below this the counter's noise is taken to hide the sign of the difference: some ten of its steps, Hz.
const SIGN_FADES_BELOW_HZ: f32 = 0.01;

/// Δf = sgn(Δf0)·√(Δf0² − fL²).
pub struct LockIn;

impl<R: Real> Effect<R> for LockIn {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn disturb(&self, moment: &Moment<R>, &[range_hz, ..]: &Coefficients<R>) -> Disturbance<R> {
        let seen_hz = moment.now.delta_f_hz;
        let fade_hz = R::from_f32(SIGN_FADES_BELOW_HZ);
        let pull = range_hz * range_hz / (seen_hz * seen_hz + fade_hz * fade_hz);
        // 1 − √(1 + pull), without the difference of two numbers close to one.
        Disturbance::of_delta_f(-(seen_hz * (pull / (R::ONE + (R::ONE + pull).sqrt()))))
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn it_undoes_what_adler_says() {
        for free_hz in [2.1, 10.0, 76.0, -3.0, -160.0] {
            let seen_hz = libm::copysign(libm::sqrt(free_hz * free_hz - 4.0), free_hz);
            let found_hz = Bench::delta_f_hz(seen_hz).disturbance(&LockIn, &[2.0]).delta_f_hz;
            // What the fading sign takes is a milli-g at the very edge of the range and nothing beyond.
            let tolerance_hz = 1e-4 * (seen_hz * seen_hz).recip().max(1e-5);
            assert!((found_hz - (seen_hz - free_hz)).abs() < tolerance_hz, "{free_hz} Hz: {found_hz}");
        }
    }

    #[test]
    fn at_76_hz_the_pull_is_26_millihertz() {
        let seen_hz = libm::sqrt(76.0 * 76.0 - 4.0);
        assert_near(Bench::delta_f_hz(seen_hz).disturbance(&LockIn, &[2.0]).delta_f_hz, -0.026_320_347);
    }

    #[test]
    fn locked_it_stays_in_the_middle() {
        let corrected_hz = |seen_hz: f64| seen_hz - Bench::delta_f_hz(seen_hz).disturbance(&LockIn, &[2.0]).delta_f_hz;
        assert!(corrected_hz(0.0).abs() < 1e-12);
        assert!(corrected_hz(0.001) > 0.0 && corrected_hz(0.001) < 0.3 && corrected_hz(-0.001) > -0.3);
    }
}
