//! Is it an accelerometer? Readings between the levels at which the paper trains and tests: −1, 0 and +1 g.

use super::truth::Truth;
use crate::campaign::{Row, Run};
use crate::noise::rms;
use protocol::Sample;

/// What the figures mean.
pub const DEFINITION: &str = "swept without noise over −1 … +1 g in steps of 25 mg at 11 temperatures from −40 to \
    60 °C, the truth being the simulated device's: residual at ±0.5 g = RMS over both and all temperatures, with the offset \
    that turn-on and mounting leave in any calibration; slope \
    error = the largest departure of a step's reading from 25 mg, in ppm.";

/// Steps from −1 to +1 g.
const STEPS: i32 = 80;
/// The level halfway between those that the paper knows, in steps from 0 g.
const HALF_G: i32 = STEPS / 4;
const TEMPERATURES_C: [i32; 11] = [-40, -30, -20, -10, 0, 10, 20, 30, 40, 50, 60];
/// Power has been on for a day and everything has settled.
const SETTLED_US: u64 = 86_400_000_000;

/// Residuals over the whole range of acceleration and temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// One curve a temperature.
    pub curves: Vec<Curve>,
}

/// Residuals over acceleration at one temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The temperature, °C.
    pub temperature_c: f64,
    /// Acceleration and residual, both g, in steps of 25 mg.
    pub points: Vec<[f64; 2]>,
}

impl Sweep {
    /// Asks for the residual, g, of one settled sample at a time.
    ///
    /// # Errors
    /// Those of `residual_g`.
    pub fn of<E>(truth: &dyn Truth, residual_g: impl Fn(&Run) -> Result<f64, E>) -> Result<Self, E> {
        let curve = |temperature_c: &i32| {
            let temperature_c = f64::from(*temperature_c);
            let point = |step: i32| {
                let acceleration_g = f64::from(step) * 2.0 / f64::from(STEPS);
                let run = settled(truth.delta_f_hz(acceleration_g, temperature_c), temperature_c, acceleration_g);
                Ok([acceleration_g, residual_g(&run)?])
            };
            let points = (-STEPS / 2..=STEPS / 2).map(point).collect::<Result<_, E>>()?;
            Ok(Curve { temperature_c, points })
        };
        Ok(Self { curves: TEMPERATURES_C.iter().map(curve).collect::<Result<_, E>>()? })
    }

    /// RMS residual at −0.5 and +0.5 g over all temperatures, µg.
    #[must_use]
    pub fn at_half_g_ug(&self) -> f64 {
        let middle = STEPS / 2;
        let halves = [middle - HALF_G, middle + HALF_G].map(|index| index as usize);
        let residuals = self.curves.iter().flat_map(|curve| halves.map(|index| curve.points[index][1]));
        rms(&residuals.collect::<Vec<_>>()) * 1e6
    }

    /// The largest departure of a step of the reading from the step of the acceleration, ppm.
    #[must_use]
    pub fn worst_slope_ppm(&self) -> f64 {
        let steps = self.curves.iter().flat_map(|curve| curve.points.windows(2));
        steps.map(|pair| ((pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).abs()).fold(0.0, f64::max) * 1e6
    }
}

/// A run of one sample, taken when everything had come to rest.
fn settled(delta_f_hz: f64, temperature_c: f64, reference_g: f64) -> Run {
    let micro = |value: f64| (value * 1e6).round();
    let sample = Sample::from_difference(SETTLED_US, micro(delta_f_hz) as i64, micro(temperature_c) as i32);
    let row = Row { sample, reference_g, reference_sigma_g: None };
    Run { name: "settled".to_owned(), kind: "static".to_owned(), source: "sweep".into(), rows: vec![row] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// 80 Hz/g and nothing else.
    struct Line;

    impl Truth for Line {
        fn delta_f_hz(&self, acceleration_g: f64, _: f64) -> f64 {
            80.0 * acceleration_g
        }

        fn acceleration_g(&self, delta_f_hz: f64, _: f64) -> f64 {
            delta_f_hz / 80.0
        }
    }

    fn sweep(reading_g: impl Fn(f64) -> f64) -> Sweep {
        let residual_g = |run: &Run| {
            let Row { sample, reference_g, .. } = run.rows[0];
            Ok::<_, Infallible>(reading_g(sample.delta_f_uhz as f64 * 1e-6 / 80.0) - reference_g)
        };
        Sweep::of(&Line, residual_g).unwrap_or_else(|never| match never {})
    }

    #[test]
    fn a_classifier_of_three_levels_is_perfect_at_them_and_found_out_between_them() {
        let classifier = sweep(f64::round);
        for [acceleration_g, residual_g] in classifier.curves[0].points.iter().filter(|point| point[0].fract() == 0.0) {
            assert!(residual_g.abs() < 1e-9, "{acceleration_g}");
        }
        assert!((classifier.at_half_g_ug() - 5e5).abs() < 1.0);
        assert!(classifier.worst_slope_ppm() > 9e5);
    }

    #[test]
    fn a_scale_factor_error_is_its_own_slope_error() {
        let proportional = sweep(|acceleration_g| acceleration_g * 1.0001);
        assert!((proportional.at_half_g_ug() - 50.0).abs() < 0.1);
        assert!((proportional.worst_slope_ppm() - 100.0).abs() < 2.0, "{}", proportional.worst_slope_ppm());
    }
}
