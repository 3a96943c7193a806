//! The model equation of one accelerometer at one temperature (IEEE Std 1293), by least squares over all positions.

use super::levels::span;
use nalgebra::{DMatrix, DVector};

/// Output U at reference a: `U = K1·(K0 + a + K2·a²)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputAxis {
    /// Scale factor, output per reference.
    pub k1: f64,
    /// Bias, in the reference's unit.
    pub k0: f64,
    /// Second-order coefficient, per reference; `None` where only a line was fitted.
    pub k2: Option<f64>,
    /// Standard uncertainties of `k1` and `k0` from the scatter about the fit; `None` where nothing is left over.
    pub sigma: Option<[f64; 2]>,
}

/// A curve needs a position that is at least this part of the span away from both ends.
const INNER: f64 = 0.1;

/// Whether the references carry a second-order coefficient: some lie well between the ends.
#[must_use]
pub fn carries_second_order(references: &[f64]) -> bool {
    let low = references.iter().copied().fold(f64::INFINITY, f64::min);
    let span = span(references);
    references.iter().any(|reference| (INNER..=1.0 - INNER).contains(&((reference - low) / span)))
}

impl InputAxis {
    /// The fit to (reference, output) of each position, all of the same weight; `None` where the references are all
    /// the same or the output does not follow them.
    #[must_use]
    pub fn fit(positions: &[[f64; 2]], second_order: bool) -> Option<Self> {
        let references: Vec<f64> = positions.iter().map(|position| position[0]).collect();
        let outputs = DVector::from_iterator(positions.len(), positions.iter().map(|position| position[1]));
        let half = span(&references) / 2.0;
        let terms = if second_order { 3 } else { 2 };
        if half <= 0.0 || positions.len() < terms {
            return None;
        }
        // Scaled by the span and about the middle, so that no unit and no offset costs digits.
        let middle = references.iter().copied().fold(f64::INFINITY, f64::min) + half;
        let design = DMatrix::from_fn(positions.len(), terms, |row, power| {
            ((references[row] - middle) / half).powi(power as i32)
        });
        let inverse = (design.transpose() * &design).try_inverse()?;
        let fitted = &inverse * (design.transpose() * &outputs);
        let left = (&design * &fitted - &outputs).norm_squared();
        let freedom = positions.len() - terms;
        let variance = (freedom > 0).then(|| left / freedom as f64);
        Self::about_zero(&fitted, &inverse, middle / half, half, variance)
    }

    /// From a polynomial about the middle in half spans to one about zero in the reference's unit.
    fn about_zero(
        fitted: &DVector<f64>,
        inverse: &DMatrix<f64>,
        middle: f64,
        half: f64,
        variance: Option<f64>,
    ) -> Option<Self> {
        let terms = fitted.len();
        let powers = |all: [f64; 3]| DVector::from_iterator(terms, all.into_iter().take(terms));
        let at_zero = powers([1.0, -middle, middle * middle]);
        let slope_at_zero = powers([0.0, 1.0 / half, -2.0 * middle / half]);
        let (u0, k1) = (at_zero.dot(fitted), slope_at_zero.dot(fitted));
        let k0 = u0 / k1;
        // K0 is a quotient: its change follows those of both.
        let k0_of = (at_zero - &slope_at_zero * k0) / k1;
        let sigma_of = |of: &DVector<f64>, variance: f64| ((of.transpose() * inverse * of)[0] * variance).sqrt();
        let k2 = fitted.get(2).map(|curve| curve / (half * half) / k1);
        let sigma = variance.map(|variance| [sigma_of(&slope_at_zero, variance), sigma_of(&k0_of, variance)]);
        // No slope makes it a division by zero.
        k0.is_finite().then_some(Self { k1, k0, k2, sigma })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const K0: f64 = 3e-3;
    const K1: f64 = -420.0;
    const K2: f64 = 40e-6;

    fn output(reference: f64) -> f64 {
        K1 * (K0 + reference + K2 * reference * reference)
    }

    fn positions(references: impl IntoIterator<Item = f64>) -> Vec<[f64; 2]> {
        references.into_iter().map(|reference| [reference, output(reference)]).collect()
    }

    fn tumble(count: u32) -> Vec<f64> {
        (0..count).map(|k| (f64::from(k) * std::f64::consts::TAU / f64::from(count)).cos()).collect()
    }

    fn near(found: f64, expected: f64) -> bool {
        (found - expected).abs() < 1e-9 * expected.abs()
    }

    #[test]
    fn a_tumble_of_any_number_of_positions_gives_back_its_coefficients() {
        for count in [8, 24, 36] {
            let fit = InputAxis::fit(&positions(tumble(count)), true).expect("a fit");
            assert!(near(fit.k1, K1) && near(fit.k0, K0) && (fit.k2.expect("a curve") / K2 - 1.0).abs() < 1e-6);
            assert!(fit.sigma.is_some_and(|sigma| sigma[0] < 1e-9 && sigma[1] < 1e-9));
        }
        let three = InputAxis::fit(&positions([-1.0, 0.0, 1.0]), true).expect("a fit");
        assert!(near(three.k1, K1) && near(three.k0, K0) && three.sigma.is_none(), "nothing is left over");
    }

    #[test]
    fn where_the_levels_lie_unevenly_two_points_take_the_curve_for_slope_and_the_fit_does_not() {
        let uneven = [1.0, 0.5, 0.0, -0.5];
        let two_points = (output(1.0) - output(-0.5)) / 1.5;
        assert!((two_points / K1 - 1.0 - K2 * 0.5).abs() < 1e-9, "20 ppm off");
        let fit = InputAxis::fit(&positions(uneven), true).expect("a fit");
        assert!(near(fit.k1, K1) && near(fit.k0, K0) && (fit.k2.expect("a curve") / K2 - 1.0).abs() < 1e-6);
        let line = InputAxis::fit(&positions([1.0, -0.5]), false).expect("a line");
        assert!(near(line.k1, two_points) && line.k2.is_none() && line.sigma.is_none());
    }

    #[test]
    fn the_uncertainty_is_what_the_scatter_makes_of_the_coefficients() {
        // 24 positions, deviations of ±1 Hz in turn: σ² = 24/21, Σcos² = 12.
        let mut scattered = positions(tumble(24));
        for (index, position) in scattered.iter_mut().enumerate() {
            position[1] += if index % 2 == 0 { 1.0 } else { -1.0 };
        }
        let fit = InputAxis::fit(&scattered, true).expect("a fit");
        let [k1_sigma, k0_sigma] = fit.sigma.expect("24 positions, three unknowns");
        assert!((k1_sigma / (24.0_f64 / 21.0 / 12.0).sqrt() - 1.0).abs() < 1e-6, "{k1_sigma}");
        // 1/24 for the mean, and as much again times two for telling it from the curve.
        assert!((k0_sigma * K1.abs() / (24.0_f64 / 21.0 * 3.0 / 24.0).sqrt() - 1.0).abs() < 1e-3, "{k0_sigma}");
    }

    #[test]
    fn the_uncertainty_of_a_large_bias_is_that_of_a_quotient() {
        // Two positions at 0 and two at 1, ±1 off in turn: σ² = 2; Var U₀ = σ²/2, Var K1 = σ², Cov = −σ²/2, so that
        // Var K0 = σ²/K1²·(1/2 + K0² + K0), and K0 = 2.
        let positions = [[0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [1.0, -1.0]].map(|[a, off]| [a, 10.0 * (2.0 + a) + off]);
        let fit = InputAxis::fit(&positions, false).expect("a line");
        let [k1_sigma, k0_sigma] = fit.sigma.expect("four positions, two unknowns");
        assert!(near(fit.k1, 10.0) && near(fit.k0, 2.0), "{fit:?}");
        assert!(near(k1_sigma, 2.0_f64.sqrt()) && near(k0_sigma, 13.0_f64.sqrt() / 10.0), "{fit:?}");
    }

    #[test]
    fn two_positions_have_no_curve_wherever_they_lie() {
        for k in (0..100).map(f64::from) {
            let two = [0.1 * k, 0.7 + 0.37 * k];
            assert_eq!(InputAxis::fit(&positions(two), true), None, "{two:?}");
        }
    }

    #[test]
    fn what_has_no_slope_has_no_fit() {
        assert_eq!(InputAxis::fit(&positions([0.5, 0.5, 0.5]), false), None);
        assert_eq!(InputAxis::fit(&[[0.0, 1.0], [1.0, 1.0]], false), None);
        assert_eq!(InputAxis::fit(&positions([1.0]), false), None);
        assert!(carries_second_order(&[-1.0, 0.0, 1.0]) && !carries_second_order(&[-1.0, -0.99, 1.0]));
    }
}
