//! What an expression may consist of.

use firmware_core::program::{Input, One, Step};

/// What an expression may read besides the campaign's channels: name, meaning, what a program reads.
pub const NAMES: [(&str, &str, Input); 7] = [
    ("temperature_c", "thermometer, °C", Input::Temperature),
    ("temperature_rate", "how fast it changes, °C/s, smoothed over the fitted tau_s", Input::Rate),
    ("temperature_departure", "its distance from equilibrium with the fitted tau_s, °C", Input::Departure),
    ("delta_f_hz", "frequency difference f1 − f2, Hz", Input::DeltaF),
    ("level_g", "acceleration, g", Input::Level),
    ("power_on_s", "time since power-on, s", Input::PowerOn),
    ("age_days", "calendar age, days", Input::Age),
];

/// What an expression may apply to a value in parentheses. Squares are written `a^2`.
pub const FUNCTIONS: [(&str, One); 3] = [("abs", One::Absolute), ("sqrt", One::SquareRoot), ("exp", One::Exponential)];

/// The steps of a program, as far as they are known.
pub(super) fn steps(code: &[u8]) -> impl Iterator<Item = Step> {
    let mut rest = code;
    std::iter::from_fn(move || {
        let (step, next) = Step::next(rest)?;
        rest = next;
        Some(step)
    })
}
