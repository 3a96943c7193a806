//! Why the default is above the paper's IFA-BP where it is: measured, cell by cell.

use super::number::number;
use std::fmt::Write;
use trainer::reproduction::paper::PaperRow;
use trainer::reproduction::shortfall::Shortfall;

/// A sentence a cell; nothing where there is none.
pub fn text(shortfalls: &[Shortfall], shown: fn(&PaperRow) -> bool) -> String {
    let sentences: Vec<String> = shortfalls.iter().filter(|shortfall| shown(&shortfall.row)).map(sentence).collect();
    sentences.concat()
}

fn sentence(shortfall: &Shortfall) -> String {
    let Shortfall { row, found, perfect, campaigns, without } = shortfall;
    let mut text = format!(
        "  * {}: {}: {} against the paper's {}. ",
        row.data_set,
        row.figure.name(),
        number(*found),
        number(row.ifa_bp)
    );
    text += if shortfall.even_the_perfect_map_is_above() {
        "The sensor itself does it: its "
    } else {
        "A better static map exists: the "
    };
    let _ = write!(
        text,
        "perfect static map leaves {}, and {} … {} in the middle half of 20 campaigns with other seeds",
        number(*perfect),
        number(campaigns.lower),
        number(campaigns.upper)
    );
    if let Some((name, left)) = without {
        let _ = write!(text, "; without {name} it leaves {}", number(*left));
    }
    text + ".\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::reproduction::evolution::Quartiles;
    use trainer::reproduction::paper::ROWS;

    #[test]
    fn a_shortfall_is_laid_to_the_sensor_or_to_the_map_and_only_what_is_shown_is_told() {
        // The bias variation of the second table's first data set: 32.967 µg.
        let of = |perfect: f64, without: Option<(String, f64)>| Shortfall {
            row: ROWS[7],
            found: 60.0,
            perfect,
            campaigns: Quartiles { lower: 10.0, median: 20.0, upper: 1234.0 },
            without,
        };
        let told = text(&[of(50.0, Some(("the rig".to_owned(), 3.0)))], |_| true);
        let begin = format!("  * {}: bias variation, µg: 60.0 against the paper's 33.0. ", ROWS[7].data_set);
        let left = "leaves 50.0, and 10.0 … 1234 in the middle half of 20 campaigns with other seeds";
        assert_eq!(
            told,
            format!(
                "{begin}The sensor itself does it: its perfect static map {left}; without the rig it leaves 3.00.\n"
            )
        );
        let told = text(&[of(5.0, None)], |_| true);
        assert!(told.contains("A better static map exists: the perfect static map leaves 5.00,"), "{told}");
        assert!(told.ends_with("other seeds.\n"), "{told}");
        assert_eq!(text(&[of(5.0, None)], |row| row.table == 9), "");
    }
}
