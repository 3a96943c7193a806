//! Tables for people: columns padded to their widest cell, numbers to the right.

use crate::visible::visible_word;
use std::borrow::Cow;
use std::fmt;

/// A table with a header line.
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    pub fn new<const N: usize>(header: [&str; N]) -> Self {
        Self::of(vec![header.map(str::to_owned).to_vec()])
    }

    /// A table whose number of columns is only known at run time; the first row is the header.
    pub fn of(rows: Vec<Vec<String>>) -> Self {
        Self { rows: rows.into_iter().map(shown).collect() }
    }

    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(shown(cells.into()));
    }
}

/// A name from elsewhere must not break the line that it stands in.
fn shown(cells: Vec<String>) -> Vec<String> {
    let visible = |cell: String| match visible_word(&cell) {
        Cow::Borrowed(_) => cell,
        Cow::Owned(shown) => shown,
    };
    cells.into_iter().map(visible).collect()
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for row in &self.rows {
            let mut line = String::from(" ");
            for (index, (cell, width)) in row.iter().zip(&widths).enumerate() {
                let pad = " ".repeat(width - cell.chars().count());
                // The first column names things, the others hold figures.
                line += &if index == 0 { format!(" {cell}{pad}") } else { format!("  {pad}{cell}") };
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Table;

    #[test]
    fn a_name_that_would_move_the_cursor_stands_in_its_column() {
        let mut table = Table::new(["run", "µg"]);
        table.row(["a\u{1b}[2J\nb".to_owned(), "1".to_owned()]);
        assert_eq!(table.to_string(), "  run                µg\n  a\\u001b[2J\\u000ab   1\n");
    }

    #[test]
    fn names_stand_left_and_figures_right_also_with_letters_of_two_bytes() {
        let mut table = Table::new(["run", "µg"]);
        table.row(["zero-1".to_owned(), "12.5".to_owned()]);
        table.row(["a".to_owned(), "3".to_owned()]);
        assert_eq!(table.to_string(), "  run       µg\n  zero-1  12.5\n  a          3\n");
    }
}
