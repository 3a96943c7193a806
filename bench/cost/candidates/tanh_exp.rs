//! tanh by one exponential: 1 − 2/(e²ᵘ + 1).

use crate::real::Real;

/// σ(u).
pub fn sigmoid<R: Real>(u: R) -> R {
    let two = R::from_f32(2.0);
    R::ONE - two / ((u + u).exp() + R::ONE)
}

/// dσ/du.
pub fn slope<R: Real>(u: R) -> R {
    let s = sigmoid(u);
    R::ONE - s * s
}

/// d²σ/du².
pub fn curvature<R: Real>(u: R) -> R {
    let s = sigmoid(u);
    R::from_f32(-2.0) * s * (R::ONE - s * s)
}
