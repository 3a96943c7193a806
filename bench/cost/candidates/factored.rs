//! The house's function as u(1/9 + (8/3)/(3 + u²)): other roundings, one product less.

use crate::real::Real;

/// σ(u).
pub fn sigmoid<R: Real>(u: R) -> R {
    let three = R::from_f32(3.0);
    let u = u.between(-three, three);
    u * (R::from_f32(1.0 / 9.0) + R::from_f32(8.0 / 3.0) / (three + u * u))
}

/// dσ/du.
pub fn slope<R: Real>(u: R) -> R {
    let three = R::from_f32(3.0);
    let u = u.between(-three, three);
    let square = u * u;
    let nine = R::from_f32(9.0);
    let root = (nine - square) / (nine + three * square);
    root * root
}

/// d²σ/du².
pub fn curvature<R: Real>(u: R) -> R {
    let three = R::from_f32(3.0);
    let u = u.between(-three, three);
    let square = u * u;
    let nine = R::from_f32(9.0);
    let below = nine + three * square;
    R::from_f32(-144.0) * u * (nine - square) / (below * below * below)
}
