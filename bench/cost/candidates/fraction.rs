
/// σ(u) as numerator and denominator, the latter between 3 and 12.
pub fn fraction<R: Real>(u: R) -> (R, R) {
    let three = R::from_f32(3.0);
    let u = u.between(-three, three);
    let square = u * u;
    (u * (three + R::from_f32(1.0 / 9.0) * square), three + square)
}
