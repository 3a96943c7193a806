//! libm's tanhf.

use crate::real::Real;

/// σ(u).
pub fn sigmoid<R: Real>(u: R) -> R {
    R::from_f32(libm::tanhf(u.to_f32()))
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
