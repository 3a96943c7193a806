//! Which column means what: the data contract's names, the caller's mappings, and what remains as channels.

use super::error::{CampaignError, Facts, Missing, list};
use super::mapping::{Input, Source, map};
use super::nearest::nearest;
use super::number::{Conversion, Decimal};
use super::options::ReadOptions;
use super::table::Table;

/// The columns of one file by their meaning.
pub(super) struct Layout {
    pub(super) run: Option<Input>,
    pub(super) kind: Option<Input>,
    pub(super) time: Input,
    pub(super) power_on: Option<Input>,
    pub(super) age: Option<Input>,
    pub(super) signal: Signal,
    pub(super) sum: Option<Input>,
    pub(super) temperature: Input,
    pub(super) reference: Input,
    pub(super) reference_sigma: Option<Input>,
    /// What may be an auxiliary channel; the rows decide whether it is numeric.
    pub(super) others: Vec<Input>,
    /// Whether the caller chose `others`, so that each of them must be numeric.
    pub(super) chosen: bool,
    /// Names of the columns that are left unread.
    pub(super) ignored: Vec<String>,
}

/// How the frequency difference is written.
pub(super) enum Signal {
    /// As such.
    Difference(Input),
    /// As two frequencies, and perhaps as their difference beside them.
    Pair { f1: Input, f2: Input, difference: Option<Input> },
}

impl Layout {
    /// Finds the meaning of a table's columns.
    pub(super) fn of(table: &Table, options: &ReadOptions) -> Result<Self, CampaignError> {
        check_header(table, options)?;
        let mut inputs = Inputs::of(table, options)?;
        inputs.check_complete(options.constant_reference.is_some())?;
        let signal = inputs.signal(options.signal.is_some())?;
        Ok(Self {
            run: inputs.take("run"),
            kind: inputs.take("kind"),
            time: inputs.require("time_s")?,
            power_on: inputs.take("power_on_s"),
            age: inputs.take("age_days"),
            signal,
            sum: inputs.sum(options),
            temperature: inputs.require("temperature_c")?,
            reference: inputs.reference(options.constant_reference)?,
            reference_sigma: inputs.take("reference_sigma_g"),
            others: inputs.channels(options.channels.as_deref())?,
            chosen: options.channels.is_some(),
            ignored: inputs.ignored,
        })
    }
}

/// The inputs whose meaning is not yet known.
struct Inputs<'a> {
    table: &'a Table,
    left: Vec<Input>,
    ignored: Vec<String>,
}

impl<'a> Inputs<'a> {
    fn of(table: &'a Table, options: &ReadOptions) -> Result<Self, CampaignError> {
        let mapped: Vec<Input> =
            options.mappings().into_iter().map(|(name, text)| map(table, name, text)).collect::<Result<_, _>>()?;
        let mut inputs = Self { table, left: Vec::new(), ignored: Vec::new() };
        for (index, header) in table.header.iter().enumerate() {
            let used = mapped.iter().any(|input| input.source == Source::Cell(index));
            let hidden = options.ignore.contains(header) || mapped.iter().any(|input| input.name == *header);
            if header.is_empty() || used {
                continue;
            } else if hidden {
                inputs.ignored.push(header.clone());
            } else {
                inputs.left.push(Input::cell(header, header, index, Conversion::NONE));
            }
        }
        inputs.left.extend(mapped.into_iter().filter(|input| !options.ignore.contains(&input.name)));
        Ok(inputs)
    }

    /// Names everything that is missing at once: a foreign table lacks most names, and nobody wants to learn them singly.
    fn check_complete(&self, reference_is_constant: bool) -> Result<(), CampaignError> {
        let has = |name: &str| self.left.iter().any(|input| input.name == name);
        let required = [
            ("time_s", has("time_s")),
            ("delta_f_hz", has("delta_f_hz") || has("f1_hz") || has("f2_hz")),
            ("temperature_c", has("temperature_c")),
            ("reference_g", has("reference_g") || reference_is_constant),
        ];
        let names: Vec<&str> = required.into_iter().filter(|(_, there)| !there).map(|(name, _)| name).collect();
        let columns = if names.len() > 1 { "columns" } else { "a column" };
        let expected =
            format!("{columns} {}", names.join(", ")).replace("delta_f_hz", "delta_f_hz (or f1_hz and f2_hz)");
        if names.is_empty() { Ok(()) } else { Err(missing(self.table, &names, expected)) }
    }

    fn take(&mut self, name: &str) -> Option<Input> {
        let position = self.left.iter().position(|input| input.name == name)?;
        Some(self.left.remove(position))
    }

    /// The sum in the unit of the difference; beside a signal that is no frequency it is a channel like any other.
    fn sum(&mut self, options: &ReadOptions) -> Option<Input> {
        let power = options.quantity().power_of_hz()?;
        let mut sum = self.take("sum_f_hz")?;
        sum.conversion = sum.conversion.scaled(-power);
        Some(sum)
    }

    fn require(&mut self, name: &str) -> Result<Input, CampaignError> {
        self.take(name).ok_or_else(|| missing(self.table, &[name], format!("a column {name}")))
    }

    /// The reference's column, or the number that stands for it.
    fn reference(&mut self, constant: Option<f64>) -> Result<Input, CampaignError> {
        let Some(constant) = constant else { return self.require("reference_g") };
        let text = format!("{constant:?}");
        if !constant.is_finite() {
            let expected = "a finite number as the constant reference";
            return Err(CampaignError::BadMapping(Facts::boxed(self.table.header_place(), text, expected)));
        }
        if let Some(column) = self.take("reference_g") {
            let found = format!("a column {} beside the constant reference {text}", column.header);
            return Err(CampaignError::ReferenceTwice(Facts::boxed(self.table.header_place(), found, "one of them")));
        }
        map(self.table, "reference_g", &text)
    }

    /// The difference, the two frequencies, or both.
    fn signal(&mut self, named: bool) -> Result<Signal, CampaignError> {
        let difference = self.take("delta_f_hz");
        let pair = if named { (None, None) } else { (self.take("f1_hz"), self.take("f2_hz")) };
        let found = match (pair, difference) {
            ((Some(f1), Some(f2)), difference) => return Ok(Signal::Pair { f1, f2, difference }),
            ((None, None), Some(difference)) => return Ok(Signal::Difference(difference)),
            ((Some(_), None), _) => "f1_hz without f2_hz".to_owned(),
            ((None, Some(_)), _) => "f2_hz without f1_hz".to_owned(),
            ((None, None), None) => "neither of them".to_owned(),
        };
        let expected = "delta_f_hz alone, or both f1_hz and f2_hz";
        Err(CampaignError::HalfAPair(Facts::boxed(self.table.header_place(), found, expected)))
    }

    /// What remains, or what the caller chose of it.
    fn channels(&mut self, chosen: Option<&[String]>) -> Result<Vec<Input>, CampaignError> {
        let Some(chosen) = chosen else { return Ok(std::mem::take(&mut self.left)) };
        let channels = chosen.iter().map(|name| {
            let asked = format!("the channel {name} that `channels` names");
            self.take(name).ok_or_else(|| missing(self.table, &[name], asked))
        });
        let channels = channels.collect::<Result<_, _>>()?;
        self.ignored.extend(self.left.drain(..).map(|input| input.header));
        Ok(channels)
    }
}

fn check_header(table: &Table, options: &ReadOptions) -> Result<(), CampaignError> {
    let named = || table.header.iter().enumerate().filter(|(_, name)| !name.is_empty());
    if named().all(|(_, name)| Decimal::parse(name.as_bytes()).is_ok()) {
        let found = format!("numbers ({})", table.header.join(", "));
        return Err(CampaignError::NoHeader(Facts::boxed(table.header_place(), found, "the names of the columns")));
    }
    for (index, name) in named() {
        let first = table.header.iter().position(|other| other == name).unwrap_or(index);
        if first != index && !options.ignore.contains(name) {
            let place = table.header_place().column(Some(index + 1), name);
            let found = format!("the name of column {} again", first + 1);
            return Err(CampaignError::DuplicateColumn(Facts::boxed(place, found, "a name of its own")));
        }
    }
    Ok(())
}

fn missing(table: &Table, names: &[&str], expected: String) -> CampaignError {
    let facts = Facts::boxed(table.header_place(), list("columns", &table.header), expected);
    let missing = names.iter().map(|&name| Missing { column: name.to_owned(), nearest: nearest(name, &table.header) });
    CampaignError::MissingColumn { facts, missing: missing.collect() }
}
