//! The cells of one record as numbers, each refusal with its place.

use super::error::{CampaignError, Facts, Place, quoted, shortened};
use super::limits::{self, MAX_NAME};
use super::mapping::{Input, Source};
use super::number::{Decimal, NotDecimal};
use super::table::{Table, clean};
use csv::ByteRecord;

/// What an i64 of millionths holds.
pub(super) const ANY: &str = "a number from -9.2e12 to 9.2e12";
/// The same as a number. A float could be larger, and its square or its part of a reading could not.
const LARGEST: f64 = i64::MAX as f64 * 1e-6;

/// One record of a table.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a> {
    /// The table.
    pub(super) table: &'a Table,
    /// The record.
    pub(super) record: &'a ByteRecord,
    /// Its number among the rows, from 0.
    pub(super) row: u64,
}

impl<'a> Cells<'a> {
    /// Refuses a record that is longer or shorter than the header.
    pub(super) fn check_count(&self) -> Result<(), CampaignError> {
        let (found, expected) = (self.record.len(), self.table.header.len());
        if found == expected {
            return Ok(());
        }
        let (found, expected) = (format!("{found} cells"), format!("{expected}, as in the header"));
        Err(CampaignError::WrongCellCount(Facts::boxed(self.line(), found, expected)))
    }

    /// The text of an input, without blanks around it; empty for an input that has no cell.
    pub(super) fn raw(&self, input: &Input) -> &'a [u8] {
        match input.source {
            Source::Cell(index) => clean(self.record.get(index).unwrap_or_default()),
            Source::Row | Source::Constant(_) => &[],
        }
    }

    /// A name, which must not be empty.
    pub(super) fn name(&self, input: &Input) -> Result<&'a str, CampaignError> {
        let name = self.raw(input);
        if name.is_empty() {
            return Err(CampaignError::EmptyCell(Facts::boxed(self.place(input), "an empty cell", "a name")));
        }
        if name.len() > MAX_NAME {
            let found = format!("a name of {}, {}", limits::bytes(name.len() as u64), quoted(name));
            let expected = format!("at most {}", limits::bytes(MAX_NAME as u64));
            return Err(CampaignError::TooLong(Facts::boxed(self.place(input), found, expected)));
        }
        // The whole file was checked to be UTF-8; a cell ends at ASCII characters.
        Ok(std::str::from_utf8(name).unwrap_or_default())
    }

    /// The number as written.
    pub(super) fn decimal(&self, input: &Input) -> Result<Decimal, CampaignError> {
        self.decimal_or(input, "a number")
    }

    /// The number as written, or the error that expects `expected` in its place.
    pub(super) fn decimal_or(&self, input: &Input, expected: &str) -> Result<Decimal, CampaignError> {
        match input.source {
            Source::Cell(_) => Decimal::parse(self.raw(input)).map_err(|why| self.no_number(input, why, expected)),
            Source::Row => Ok(Decimal::whole(self.row)),
            Source::Constant(constant) => Ok(constant),
        }
    }

    /// The number in millionths of our unit, as an integer of the sample. `range` says what fits.
    pub(super) fn micro<T: TryFrom<i64>>(&self, input: &Input, range: &str) -> Result<T, CampaignError> {
        let number = self.decimal(input)?;
        let micro = input.conversion.micro(number).and_then(|micro| T::try_from(micro).ok());
        micro.ok_or_else(|| self.out_of_range(input, range))
    }

    /// The number in our unit, as a float.
    pub(super) fn real(&self, input: &Input) -> Result<f64, CampaignError> {
        let decimal = self.decimal(input)?;
        let text = std::str::from_utf8(self.raw(input)).unwrap_or_default();
        let number = input.conversion.real(text.parse().unwrap_or_else(|_| decimal.to_f64()));
        // Adding zero turns −0 into 0, which is the same reference.
        if number.abs() <= LARGEST { Ok(number + 0.0) } else { Err(self.out_of_range(input, ANY)) }
    }

    /// A number that does not fit into `range`.
    pub(super) fn out_of_range(&self, input: &Input, range: &str) -> CampaignError {
        let found = match input.source {
            Source::Cell(_) => shortened(self.raw(input)),
            Source::Row | Source::Constant(_) => input.header.clone(),
        };
        CampaignError::OutOfRange(Facts::boxed(self.place(input), found, range))
    }

    /// Text that is no number.
    fn no_number(&self, input: &Input, why: NotDecimal, expected: &str) -> CampaignError {
        let (place, found) = (self.place(input), quoted(self.raw(input)));
        match why {
            NotDecimal::Empty => CampaignError::EmptyCell(Facts::boxed(place, "an empty cell", expected)),
            NotDecimal::NotFinite => CampaignError::NotFinite(Facts::boxed(place, found, "a finite number")),
            NotDecimal::Text => CampaignError::NotANumber(Facts::boxed(place, found, expected)),
        }
    }

    /// Where an input stands.
    pub(super) fn place(&self, input: &Input) -> Place {
        match input.source {
            Source::Cell(index) => {
                let name = self.table.header.get(index).map_or("", String::as_str);
                self.line().mapped_column(Some(index + 1), name, &input.name)
            }
            Source::Row | Source::Constant(_) => self.line().column(None, &input.name),
        }
    }

    /// Where the record stands.
    pub(super) fn line(&self) -> Place {
        Place::file(&self.table.file).line(self.table.line(self.record))
    }
}
