//! The two functions on which Huang et al. (Micromachines 2022, 13, 1054, §2.2.3) compare their optimisers.
//!
//! Separate, because tests, the reproduction of the paper's figures 3 and 4 and examples all need the very
//! same functions. The paper draws them (figure 2) without formula and without domain; the forms here are
//! the customary ones with the minima that the paper names, −1 and 0, at the origin. The missing domain
//! decides everything: on |x| ≤ 1 nearly every search succeeds, on the customary domains few do.

use std::f64::consts::TAU;

/// A function with many local minima and one global one, at the origin.
#[derive(Clone, Copy, Debug)]
pub struct TestFunction {
    /// What it is called.
    pub name: &'static str,
    /// The function, for any number of dimensions; the paper uses two.
    pub cost: fn(&[f64]) -> f64,
    /// The global minimum.
    pub minimum: f64,
    /// Below this cost only the basin of the global minimum is left: a search that ends here has found it.
    pub global_basin: f64,
}

/// Schaffer's function: concentric rings around the origin. The first ring's floor, at r ≈ π, is −0.9903.
pub const SCHAFFER: TestFunction =
    TestFunction { name: "Schaffer", cost: schaffer, minimum: -1.0, global_basin: -0.995 };

/// Rastrigin's function: a parabola under a grid of dimples. The next lowest minima, at one unit, are 0.995.
pub const RASTRIGIN: TestFunction =
    TestFunction { name: "Rastrigin", cost: rastrigin, minimum: 0.0, global_basin: 0.5 };

impl TestFunction {
    /// Whether this cost can only belong to the basin of the global minimum.
    #[must_use]
    pub fn found(&self, cost: f64) -> bool {
        cost < self.global_basin
    }
}

/// (sin² r − ½) / (1 + 0.001 r²)² − ½ with r = ‖x‖; customary domain |x| ≤ 100.
#[must_use]
pub fn schaffer(x: &[f64]) -> f64 {
    let r2: f64 = x.iter().map(|v| v * v).sum();
    let sine = r2.sqrt().sin();
    let widening = 1.0 + 0.001 * r2;
    (sine * sine - 0.5) / (widening * widening) - 0.5
}

/// Σ (x² − 10 cos 2πx + 10); customary domain |x| ≤ 5.12.
#[must_use]
pub fn rastrigin(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v - 10.0 * (TAU * v).cos() + 10.0).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn the_minima_are_the_papers() {
        for function in [SCHAFFER, RASTRIGIN] {
            assert_eq!((function.cost)(&[0.0, 0.0]), function.minimum, "{}", function.name);
        }
    }

    #[test]
    fn schaffer_is_a_set_of_rings() {
        let on_the_first_ring = [PI, 1.0, 0.0].map(|angle: f64| {
            let (sin, cos) = angle.sin_cos();
            schaffer(&[PI * cos, PI * sin])
        });
        assert!(on_the_first_ring.iter().all(|cost| (cost + 0.990_275).abs() < 1e-6));
        assert!((schaffer(&[FRAC_PI_2, 0.0]) + 0.002_458).abs() < 1e-6, "the wall before it");
    }

    #[test]
    fn rastrigin_at_whole_numbers_is_the_parabola() {
        assert!((rastrigin(&[1.0, -2.0]) - 5.0).abs() < 1e-12);
        assert!((rastrigin(&[0.5, 0.0]) - 20.25).abs() < 1e-12);
    }

    /// The thresholds lie between the global minimum and the lowest local one, found by a fine scan.
    #[test]
    fn the_thresholds_separate_the_global_basin() {
        let lowest_outside = |function: TestFunction, from: f64, to: f64| {
            (0..=4000)
                .map(|i| (function.cost)(&[from + (to - from) * f64::from(i) / 4000.0, 0.0]))
                .fold(f64::INFINITY, f64::min)
        };
        for (function, edge, far) in [(SCHAFFER, FRAC_PI_2, 20.0), (RASTRIGIN, 0.5, 5.12)] {
            let next = lowest_outside(function, edge, far);
            assert!(function.found(function.minimum) && !function.found(next), "{next}");
        }
    }
}
