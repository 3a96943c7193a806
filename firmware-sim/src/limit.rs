//! The limits that every number of a scenario is held to, and the sentence that a violation becomes.

use std::fmt::Display;

/// The coldest and the hottest a chamber goes, °C.
pub(crate) const CHAMBER_C: (f64, f64) = (-80.0, 180.0);
/// The longest any part of a run may last: a year, s.
pub(crate) const LONGEST_S: f64 = 366.0 * 86_400.0;

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

    fn number(field: &str, found: f64, expected: &str) -> Self {
        // 1e308 is no number to be read in full.
        let is_plain = found == 0.0 || (1e-6..1e15).contains(&found.abs()) || !found.is_finite();
        Self::new(field, &if is_plain { found.to_string() } else { format!("{found:e}") }, expected)
    }
}

/// # Errors
/// Unless `min ≤ value ≤ max`; a NaN is never inside.
pub fn within(field: &str, value: f64, min: f64, max: f64) -> Result<(), Fault> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(Fault::number(field, value, &format!("between {min} and {max}")))
}

/// # Errors
/// Unless the value is above zero, and a number that a laboratory could mean.
pub fn positive(field: &str, value: f64) -> Result<(), Fault> {
    up_to(field, value, 1e9)
}

/// # Errors
/// Unless the value is above zero and at most `most`.
pub fn up_to(field: &str, value: f64, most: f64) -> Result<(), Fault> {
    if value > 0.0 && value <= most {
        return Ok(());
    }
    Err(Fault::number(field, value, &format!("above zero and at most {most}")))
}

/// # Errors
/// Unless the list has an entry, not too many, and every entry lies between `min` and `max`.
pub fn each_within(field: &str, values: &[f64], min: f64, max: f64) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(field, &"an empty list", "a list with at least one entry"));
    }
    not_too_many(field, values)?;
    values.iter().try_for_each(|value| within(field, *value, min, max))
}

/// As many as there are degrees in a circle: a run takes every entry of one list with every entry of the others.
const MOST_ENTRIES: usize = 360;

/// # Errors
/// If a list is longer than any programme of a laboratory.
pub fn not_too_many(field: &str, values: &[f64]) -> Result<(), Fault> {
    if values.len() <= MOST_ENTRIES {
        return Ok(());
    }
    let found = format!("a list of {} entries", values.len());
    Err(Fault::new(field, &found, &format!("a list of at most {MOST_ENTRIES}")))
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
        assert!(each_within("nodes_c", &[20.0; 361], -40.0, 60.0).is_err());
        let fault = up_to("dwell_s", 1e308, 31_622_400.0).unwrap_err();
        assert_eq!(fault.to_string(), "`dwell_s` is 1e308; it must be above zero and at most 31622400");
    }
}
