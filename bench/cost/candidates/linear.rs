//! No bend at all: what the sums cost.

use crate::real::Real;

/// σ(u) = u.
pub fn sigmoid<R: Real>(u: R) -> R {
    u
}

/// dσ/du.
pub fn slope<R: Real>(_: R) -> R {
    R::ONE
}

/// d²σ/du².
pub fn curvature<R: Real>(_: R) -> R {
    R::ZERO
}
