//! The noise that an Allan plot shows: white, flicker, random walk, with their uncertainties.

use super::allan::AllanPoint;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// What the coefficients mean.
pub const DEFINITION: &str = "σ²(τ) = N²/τ + (2 ln 2/π)·B² + K²·τ/3: white noise N, bias instability B, random walk \
    K, none negative, least squares of σ² weighted by the uncertainty of each point; a coefficient is stated if it \
    improves the fit.";

/// Coefficients of the fit, with their standard uncertainties; zero of what the plot does not show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AllanModel {
    /// White noise, µg·√s.
    pub white_ug_sqrt_s: Coefficient,
    /// Bias instability, µg.
    pub flicker_ug: Coefficient,
    /// Random walk, µg/√s.
    pub walk_ug_per_sqrt_s: Coefficient,
}

/// A value and its standard uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coefficient {
    /// The value.
    pub value: f64,
    /// Its standard uncertainty.
    pub sigma: f64,
}

/// Variance of flicker noise of unit B: 2 ln 2/π.
const FLICKER: f64 = 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI;

impl AllanModel {
    /// Fits the squares of all points; `None` of fewer than four.
    #[must_use]
    pub fn fit(points: &[AllanPoint]) -> Option<Self> {
        if points.len() < 4 {
            return None;
        }
        // Every choice of terms; of those without a negative one, the best.
        let fits = (1_u8..8).filter_map(|terms| fit(points, terms));
        let best = fits.min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
        let coefficient = |index: usize| {
            let value = best.squares[index].max(0.0).sqrt();
            Coefficient { value, sigma: if value > 0.0 { best.sigmas[index] / (2.0 * value) } else { 0.0 } }
        };
        Some(Self { white_ug_sqrt_s: coefficient(0), flicker_ug: coefficient(1), walk_ug_per_sqrt_s: coefficient(2) })
    }

    /// The deviation at an averaging time, µg.
    #[must_use]
    pub fn deviation_ug(&self, tau_s: f64) -> f64 {
        let squares = [self.white_ug_sqrt_s, self.flicker_ug, self.walk_ug_per_sqrt_s].map(|c| c.value * c.value);
        basis(tau_s).iter().zip(squares).map(|(by, square)| by * square).sum::<f64>().sqrt()
    }
}

fn basis(tau_s: f64) -> [f64; 3] {
    [1.0 / tau_s, FLICKER, tau_s / 3.0]
}

struct Fit {
    squares: Vector3<f64>,
    sigmas: Vector3<f64>,
    misfit: f64,
}

/// Weighted least squares with the terms whose bits are set; `None` where one comes out negative.
fn fit(points: &[AllanPoint], terms: u8) -> Option<Fit> {
    let used = |index: usize| terms >> index & 1 == 1;
    let masked = |tau_s: f64| {
        let by = basis(tau_s);
        Vector3::from_fn(|index, _| if used(index) { by[index] } else { 0.0 })
    };
    // An unused term gets a one on the diagonal, so that the matrix can be inverted.
    let mut normal = Matrix3::from_diagonal(&Vector3::from_fn(|index, _| f64::from(u8::from(!used(index)))));
    let mut right = Vector3::zeros();
    let weight = |point: &AllanPoint| (2.0 * point.deviation_ug.powi(2) * point.relative_uncertainty).powi(-2);
    for point in points {
        let by = masked(point.tau_s);
        normal += by * by.transpose() * weight(point);
        right += by * point.deviation_ug.powi(2) * weight(point);
    }
    let inverse = normal.try_inverse()?;
    let squares = inverse * right;
    if (0..3).any(|index| used(index) && squares[index] < 0.0) {
        return None;
    }
    let misfit = points
        .iter()
        .map(|point| weight(point) * (point.deviation_ug.powi(2) - masked(point.tau_s).dot(&squares)).powi(2))
        .sum();
    Some(Fit { squares, sigmas: inverse.diagonal().map(f64::sqrt), misfit })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO_LN_2_OVER_PI: f64 = 0.441_271_200_305_303;

    fn points(of: impl Fn(f64) -> f64) -> Vec<AllanPoint> {
        let point = |k: i32| {
            let tau_s = 2.0_f64.powi(k);
            AllanPoint { tau_s, deviation_ug: of(tau_s).sqrt(), relative_uncertainty: 0.01 * tau_s.sqrt() }
        };
        (0..10).map(point).collect()
    }

    #[test]
    fn the_coefficients_of_a_plot_are_found_again() {
        let model =
            AllanModel::fit(&points(|tau| 16.0 / tau + TWO_LN_2_OVER_PI * 2.25 + 0.0016 * tau / 3.0)).expect("enough");
        assert!((model.white_ug_sqrt_s.value - 4.0).abs() < 1e-6);
        assert!((model.flicker_ug.value - 1.5).abs() < 1e-6);
        assert!((model.walk_ug_per_sqrt_s.value - 0.04).abs() < 1e-6);
        assert!(model.white_ug_sqrt_s.sigma > 0.0 && model.white_ug_sqrt_s.sigma < 0.1);
        assert!((model.deviation_ug(1.0).powi(2) - (16.0 + TWO_LN_2_OVER_PI * 2.25 + 0.0016 / 3.0)).abs() < 1e-6);
    }

    #[test]
    fn what_is_not_there_is_zero_and_never_negative() {
        let model = AllanModel::fit(&points(|tau| 16.0 / tau * (1.0 - 0.01 * tau.log2() / 9.0))).expect("enough");
        assert!((model.white_ug_sqrt_s.value - 4.0).abs() < 0.05);
        let none = Coefficient { value: 0.0, sigma: 0.0 };
        assert_eq!((model.flicker_ug, model.walk_ug_per_sqrt_s), (none, none));
        // Var N² = 1/Σ(1/(2·N²·0.01·√τ))² = 4·N⁴·10⁻⁴/Σ1/τ with Σ1/τ = 2 − 2⁻⁹, and σ(N) = σ(N²)/2N.
        let expected = 4.0 * 0.01 / (2.0 - 2.0_f64.powi(-9)).sqrt();
        assert!((model.white_ug_sqrt_s.sigma / expected - 1.0).abs() < 0.02, "{model:?} {expected}");
    }

    #[test]
    fn four_points_are_enough_and_three_are_not() {
        let plot = points(|tau| 16.0 / tau);
        assert!(AllanModel::fit(&plot[..4]).is_some() && AllanModel::fit(&plot[..3]).is_none());
    }

    /// Squares of what the model misses, each over its uncertainty.
    fn misfit(model: &AllanModel, points: &[AllanPoint]) -> f64 {
        let off = |point: &AllanPoint| {
            let square = point.deviation_ug.powi(2);
            ((model.deviation_ug(point.tau_s).powi(2) - square) / (2.0 * square * point.relative_uncertainty)).powi(2)
        };
        points.iter().map(off).sum()
    }

    #[test]
    fn no_model_nearby_fits_better() {
        let point =
            |(tau_s, deviation_ug, relative_uncertainty)| AllanPoint { tau_s, deviation_ug, relative_uncertainty };
        let uncertain_start = [4.6, 2.5, 2.2, 1.8, 1.7, 1.65, 1.75, 2.0];
        let uncertain_start: Vec<AllanPoint> = (0..)
            .zip(uncertain_start)
            .map(|(k, deviation_ug)| {
                point((2.0_f64.powi(k), deviation_ug, if k == 0 { 0.3 } else { 0.01 * 1.4_f64.powi(k) }))
            })
            .collect();
        let uneven = [
            (1.0, 4.39, 0.01),
            (2.0, 2.72, 0.009),
            (4.0, 1.46, 0.088),
            (8.0, 2.3, 0.021),
            (16.0, 1.5, 0.075),
            (32.0, 1.24, 0.102),
        ];
        for points in [uncertain_start, uneven.map(point).to_vec(), points(|tau| 16.0 / tau + 0.1 * tau)] {
            let model = AllanModel::fit(&points).expect("enough");
            let least = misfit(&model, &points);
            for index in 0..3 {
                for by in [-1e-3, 1e-3] {
                    let mut near = model;
                    let terms = [&mut near.white_ug_sqrt_s, &mut near.flicker_ug, &mut near.walk_ug_per_sqrt_s];
                    let value = &mut terms.into_iter().nth(index).expect("three terms").value;
                    *value = (*value * *value + by).max(0.0).sqrt();
                    assert!(misfit(&near, &points) >= least - 1e-9, "{model:?}: {near:?}");
                }
            }
        }
    }
}
