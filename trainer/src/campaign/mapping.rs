//! What stands for a name of ours in a table: a column, a conversion of one, the row's number, or a number.

use super::error::{CampaignError, Facts, Missing, list, quoted};
use super::nearest::nearest;
use super::number::{Conversion, Decimal};
use super::table::Table;

/// Where a value comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Input {
    /// Our name for it.
    pub(super) name: String,
    /// What the file or the mapping calls it.
    pub(super) header: String,
    /// Where it stands.
    pub(super) source: Source,
    /// From the file's unit to ours.
    pub(super) conversion: Conversion,
}

/// Where a value stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    /// The cell of this index.
    Cell(usize),
    /// The number of the row, from 0.
    Row,
    /// Nowhere: it is the same for all rows.
    Constant(Decimal),
}

impl Input {
    /// A column as a whole.
    pub(super) fn cell(name: &str, header: &str, index: usize, conversion: Conversion) -> Self {
        Self { name: name.to_owned(), header: header.to_owned(), source: Source::Cell(index), conversion }
    }
}

/// Whether a table has what a mapping of another table speaks of. What needs no column gives way to a column of our name.
pub(super) fn is_there(table: &Table, name: &str, text: &str) -> bool {
    let named = table.header.iter().any(|header| header == name);
    map(table, name, text).is_ok_and(|input| matches!(input.source, Source::Cell(_)) || !named)
}

/// What a mapping's text stands for.
pub(super) fn map(table: &Table, name: &str, text: &str) -> Result<Input, CampaignError> {
    let text = text.trim();
    let input = |source, conversion| Input { name: name.to_owned(), header: text.to_owned(), source, conversion };
    if let Some(index) = table.header.iter().position(|header| header == text && !text.is_empty()) {
        return Ok(input(Source::Cell(index), Conversion::NONE));
    }
    let headers = table.header.iter().enumerate().filter(|(_, header)| !header.is_empty());
    let converted = headers.filter_map(|(index, header)| {
        let conversion = Conversion::parse(text.strip_prefix(header.as_str())?)?;
        Some(Input::cell(name, header, index, conversion))
    });
    if let Some(converted) = converted.max_by_key(|input| input.header.len()) {
        return Ok(converted);
    }
    if let Some(conversion) = text.strip_prefix("row").and_then(Conversion::parse) {
        return Ok(input(Source::Row, conversion));
    }
    match Decimal::parse(text.as_bytes()) {
        Ok(constant) => Ok(input(Source::Constant(constant), Conversion::NONE)),
        Err(_) => Err(bad_mapping(table, name, text)),
    }
}

fn bad_mapping(table: &Table, name: &str, text: &str) -> CampaignError {
    let column = text.find(['*', '/']).and_then(|end| text.get(..end)).unwrap_or(text).trim();
    if column.is_empty() || table.header.iter().any(|header| header == column) {
        let found = format!("{} for {name}", quoted(text.as_bytes()));
        let expected = "COLUMN, COLUMN*factor+offset, row*seconds or a number";
        return CampaignError::BadMapping(Facts::boxed(table.header_place(), found, expected));
    }
    let nearest = nearest(column, &table.header);
    let expected = format!("the column {column} that {name} is mapped to");
    let facts = Facts::boxed(table.header_place(), list("columns", &table.header), expected);
    CampaignError::MissingColumn { facts, missing: vec![Missing { column: name.to_owned(), nearest }] }
}
