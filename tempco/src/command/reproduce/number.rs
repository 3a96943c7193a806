//! A number of the tables.

/// Four significant digits at most.
pub fn number(value: f64) -> String {
    match value.abs() {
        size if size < 9.995 => format!("{value:.2}"),
        size if size < 999.5 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}
