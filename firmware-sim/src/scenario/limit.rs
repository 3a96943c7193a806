//! The limits that every number of a scenario is held to, and the sentence that a violation becomes.

use std::fmt::Display;

/// A number that cannot be used: which one, what it is, and what it may be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` is {found}; it must be {expected}")]
pub struct Fault {
    /// The key as the scenario writes it.
    pub field: String,
    /// The value that was found.
    pub found: String,
    /// What would be accepted.
    pub expected: String,
}

impl Fault {
    /// A violation that no range describes.
    #[must_use]
    pub fn new(field: &str, found: &dyn Display, expected: &str) -> Self {
        Self { field: field.into(), found: found.to_string(), expected: expected.into() }
    }
}

/// # Errors
/// Unless `min ≤ value ≤ max`; a NaN is never inside.
pub fn within(field: &str, value: f64, min: f64, max: f64) -> Result<(), Fault> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(Fault::new(field, &value, &format!("between {min} and {max}")))
}

/// # Errors
/// Unless the value is finite and above zero.
pub fn positive(field: &str, value: f64) -> Result<(), Fault> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Fault::new(field, &value, "above zero"))
}

/// # Errors
/// Unless the list has an entry and every entry lies between `min` and `max`.
pub fn each_within(field: &str, values: &[f64], min: f64, max: f64) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(field, &"an empty list", "a list with at least one entry"));
    }
    values.iter().try_for_each(|value| within(field, *value, min, max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_violation_says_what_where_and_what_would_do() {
        let fault = within("tau_s", -3.0, 1.0, 900.0).unwrap_err();
        assert_eq!(fault.to_string(), "`tau_s` is -3; it must be between 1 and 900");
        assert!(within("tau_s", f64::NAN, 1.0, 900.0).is_err());
        assert!(positive("tau_s", f64::INFINITY).is_err());
        assert!(each_within("nodes_c", &[], -40.0, 60.0).is_err());
    }
}
