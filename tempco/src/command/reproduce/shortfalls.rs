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
