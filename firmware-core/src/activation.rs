//! The hidden units' sigmoid, and its slope.
//!
//! σ(u) = ((1+u/3)³ − (1−u/3)³) / ((1+u/3)³ + (1−u/3)³) = u(27+u²) / (27+9u²) for |u| ≤ 3, ±1 beyond.
//!
//! This is tanh with eᵘ replaced by (1+u/3)³. It meets ±1 with contact of third order
//! (1 − σ = (3−u)³ / (27+9u²)), so value, slope and curvature are continuous everywhere and a
//! second-order trainer sees no seam. One division and no exponential: the cheapest smooth sigmoid
//! measured, with the same bits on every processor. Training uses this very function, so nothing is
//! approximated by it. `docs/decisions/0002-activation.md` has the comparison.

use crate::real::Real;

/// σ(u).
pub fn sigmoid<R: Real>(u: R) -> R {
    let three = R::from_f32(3.0);
    let u = u.between(-three, three);
    let square = u * u;
    let r27 = R::from_f32(27.0);
    u * (r27 + square) / (r27 + R::from_f32(9.0) * square)
}

/// dσ/du = ((9−u²) / (9+3u²))², zero beyond |u| = 3.
pub fn slope<R: Real>(u: R) -> R {
    let three = R::from_f32(3.0);
    let u = u.between(-three, three);
    let square = u * u;
    let nine = R::from_f32(9.0);
    let root = (nine - square) / (nine + three * square);
    root * root
}

/// d²σ/du², zero beyond |u| = 3.
pub fn curvature<R: Real>(u: R) -> R {
    let three = R::from_f32(3.0);
    let u = u.between(-three, three);
    let square = u * u;
    let nine = R::from_f32(9.0);
    let below = nine + three * square;
    // d/du of ((9−u²)/(9+3u²))²: the inner derivative is −72u/(9+3u²)².
    R::from_f32(-144.0) * u * (nine - square) / (below * below * below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_odd_bounded_and_monotone_over_every_thousandth_float() {
        let mut last = 0.0_f32;
        for bits in (0..f32::INFINITY.to_bits()).step_by(1009) {
            let u = f32::from_bits(bits);
            let s = sigmoid(u);
            assert!((0.0..=1.0 + f32::EPSILON).contains(&s), "σ({u}) = {s}");
            assert_eq!(sigmoid(-u).to_bits(), (-s).to_bits());
            // Near 1 the value's slope is less than its rounding: three roundings of one place each.
            assert!(s >= last - 3.0 * f32::EPSILON / 2.0, "σ({u}) = {s} after {last}");
            last = s;
        }
    }

    #[test]
    fn value_slope_and_curvature_are_continuous_at_the_seam() {
        let (inside, outside) = (3.0_f64 - 1e-6, 3.0 + 1e-6);
        assert!((sigmoid(inside) - sigmoid(outside)).abs() < 1e-15);
        assert!((slope(inside) - slope(outside)).abs() < 1e-11);
        assert!((curvature(inside) - curvature(outside)).abs() < 1e-5);
    }

    #[test]
    fn slope_and_curvature_are_the_numeric_ones() {
        for k in -50..=50 {
            let (u, h) = (f64::from(k) * 0.07, 1e-5);
            assert!(((sigmoid(u + h) - sigmoid(u - h)) / (2.0 * h) - slope(u)).abs() < 1e-9);
            assert!(((slope(u + h) - slope(u - h)) / (2.0 * h) - curvature(u)).abs() < 1e-8);
        }
    }
}
