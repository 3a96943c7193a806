//! Tables that a screen reader can walk through.

use crate::page::escaped;
use std::fmt;

/// A column: its heading, and whether it holds figures.
#[derive(Clone, Copy)]
pub enum Column {
    Text(&'static str),
    Figure(&'static str),
}

/// A table whose first column names each row.
pub struct Table {
    caption: String,
    columns: Vec<Column>,
    rows: Vec<(bool, Vec<String>)>,
}

impl Table {
    pub fn new(caption: &str, columns: impl Into<Vec<Column>>) -> Self {
        Self { caption: caption.to_owned(), columns: columns.into(), rows: Vec::new() }
    }

    /// A row of plain text.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push((false, cells.into_iter().map(|cell| escaped(&cell)).collect()));
    }

    /// A row of plain text that matters.
    pub fn marked_row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.row(cells);
        if let Some((marked, _)) = self.rows.last_mut() {
            *marked = true;
        }
    }

    /// A row of HTML.
    pub fn row_of_html(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push((false, cells.into_iter().collect()));
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "<div class=\"scroll\"><table><caption>{}</caption>\n<thead><tr>", escaped(&self.caption))?;
        for column in &self.columns {
            let (class, heading) = match column {
                Column::Text(heading) => ("", heading),
                Column::Figure(heading) => (" class=\"number\"", heading),
            };
            write!(f, "<th scope=\"col\"{class}>{}</th>", escaped(heading))?;
        }
        writeln!(f, "</tr></thead>\n<tbody>")?;
        for (marked, row) in &self.rows {
            write!(f, "<tr{}>", if *marked { " class=\"marked\"" } else { "" })?;
            for (index, (cell, column)) in row.iter().zip(&self.columns).enumerate() {
                match (index, column) {
                    (0, _) => write!(f, "<th scope=\"row\">{cell}</th>")?,
                    (_, Column::Text(_)) => write!(f, "<td>{cell}</td>")?,
                    (_, Column::Figure(_)) => write!(f, "<td class=\"number\">{cell}</td>")?,
                }
            }
            writeln!(f, "</tr>")?;
        }
        writeln!(f, "</tbody></table></div>")
    }
}

/// A figure with the digits that matter: four, and no more than three after the point.
pub fn figure(value: f64) -> String {
    let decimals = match value.abs() {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 1.0 => 2,
        _ => 3,
    };
    fixed(value, decimals)
}

/// A figure with so many digits after the point, a true minus, and groups of three from ten thousand on.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = text.split_once('.').map_or((text.as_str(), None), |(a, b)| (a, Some(b)));
    let grouped = if whole.len() > 4 { grouped(whole) } else { whole.to_owned() };
    let text = fraction.map_or(grouped.clone(), |fraction| format!("{grouped}.{fraction}"));
    let is_zero = text.chars().all(|letter| letter == '0' || letter == '.');
    if value < 0.0 && !is_zero { format!("−{text}") } else { text }
}

fn grouped(digits: &str) -> String {
    let first = digits.len() % 3;
    let groups = digits.as_bytes()[first..].chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
    let head = (first > 0).then(|| digits[..first].to_owned());
    head.into_iter().chain(groups).collect::<Vec<_>>().join("\u{202f}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_the_digits_that_matter() {
        for (value, text) in [
            (25_736.54, "25\u{202f}737"),
            (-1234.5, "−1234"),
            (1_234_567.0, "1\u{202f}234\u{202f}567"),
            (28.11, "28.1"),
            (8.214, "8.21"),
            (-0.02, "−0.020"),
            (-0.000_01, "0.000"),
        ] {
            assert_eq!(figure(value), text);
        }
    }

    #[test]
    fn names_of_files_and_runs_are_text_not_markup() {
        let mut table = Table::new("runs", [Column::Text("run"), Column::Figure("µg")]);
        table.row(["<b>".to_owned(), "1".to_owned()]);
        let html = table.to_string();
        assert!(html.contains("<th scope=\"row\">&lt;b&gt;</th><td class=\"number\">1</td>"), "{html}");
    }
}
