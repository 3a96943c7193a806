//! What each effect does to the sum of the frequencies.

use firmware_core::effect::About;

/// What an effect does to the sum of the frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SumResponse {
    /// Its contributions predict it: warmer resonators, another clock.
    Predicted,
    /// In proportion to its bias, by at most so many times what the difference moves.
    Free(f64),
}

/// Of the forks' frequencies, heat between them moves the sum by less than the difference.
const GRADIENT: f64 = 2.0;
/// Drive, charge and electronics move the sum ten times as much as the difference.
const ELECTRONICS: f64 = 40.0;
/// Stress of the package moves the sum up to a hundred times as much as the difference.
const STRESS: f64 = 400.0;

/// What this effect does to the sum.
pub fn response(about: &About) -> SumResponse {
    match about.name {
        "thermal-lag" | "self-heating" | "reference-clock" => SumResponse::Predicted,
        "thermal-gradient" | "lock-in" | "g-hysteresis" => SumResponse::Free(GRADIENT),
        "warm-up" | "supply-voltage" => SumResponse::Free(ELECTRONICS),
        _ => SumResponse::Free(STRESS),
    }
}

/// Whether the contributions of this effect predict the sum.
pub fn is_predicted(about: &About) -> bool {
    response(about) == SumResponse::Predicted
}
