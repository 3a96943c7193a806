//! A number of the tables.

/// Four significant digits at most.
pub fn number(value: f64) -> String {
    match value.abs() {
        size if size < 9.995 => format!("{value:.2}"),
        size if size < 999.5 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn a_number_has_four_digits_at_most_and_two_decimals_at_most() {
        for (value, text) in [
            (0.0, "0.00"),
            (1.234, "1.23"),
            (-9.994, "-9.99"),
            (9.995, "10.0"),
            (9.996, "10.0"),
            (186.5, "186.5"),
            (-999.4, "-999.4"),
            (999.5, "1000"),
            (999.6, "1000"),
            (20_600.4, "20600"),
        ] {
            assert_eq!(number(value), text, "{value}");
        }
    }
}
