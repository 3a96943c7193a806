//! tanh by micromath's exponential.

use crate::real::Real;

/// σ(u).
pub fn sigmoid<R: Real>(u: R) -> R {
    let e = micromath::F32Ext::exp((u + u).to_f32().clamp(-20.0, 20.0));
    R::ONE - R::from_f32(2.0) / (R::from_f32(e) + R::ONE)
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
