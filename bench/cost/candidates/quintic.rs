//! No division: σ(u) = u(1 − (2/3)w + w²/5), w = (u/c)², c = 15/8, ±1 beyond; twice continuous at the seam.

use crate::real::Real;

const END: f32 = 1.875;
const CUBE: f32 = -128.0 / 675.0;
const FIFTH: f32 = 4096.0 / 253_125.0;

/// σ(u).
pub fn sigmoid<R: Real>(u: R) -> R {
    let u = u.between(R::from_f32(-END), R::from_f32(END));
    let square = u * u;
    u * (R::ONE + square * (R::from_f32(CUBE) + R::from_f32(FIFTH) * square))
}

/// dσ/du.
pub fn slope<R: Real>(u: R) -> R {
    let u = u.between(R::from_f32(-END), R::from_f32(END));
    let square = u * u;
    R::ONE + square * (R::from_f32(3.0 * CUBE) + R::from_f32(5.0 * FIFTH) * square)
}

/// d²σ/du².
pub fn curvature<R: Real>(u: R) -> R {
    let u = u.between(R::from_f32(-END), R::from_f32(END));
    u * (R::from_f32(6.0 * CUBE) + R::from_f32(20.0 * FIFTH) * u * u)
}
