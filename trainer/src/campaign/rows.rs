//! The rows of one file, gathered into runs.

use super::cells::{ANY, Cells};
use super::columns::{Layout, Signal};
use super::error::{CampaignError, Facts, Place, quoted};
use super::limits::MAX_UPTIME_US;
use super::mapping::Input;
use super::number::{Decimal, micro_text};
use super::run::{Row, Run, UNSTATED};
use super::table::Table;
use csv::ByteRecord;
use protocol::Sample;
use protocol::limits::MAX_CHANNELS;
use std::collections::HashMap;

/// Kinds that the data contract names; their case does not matter.
const KINDS: [&str; 5] = ["full", "zero", "ramp", "tumble", "static"];
/// The same for what cannot be negative.
const NOT_NEGATIVE: &str = "a number from 0 to 9.2e12";
/// What an i32 of millionths holds.
const TEMPERATURE: &str = "a number from -2147.48 to 2147.48";
/// What a u32 of seconds holds, in days.
const AGE: &str = "a number from 0 to 49710";
/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// What one file holds.
pub(super) struct Content {
    pub(super) runs: Vec<Run>,
    pub(super) channels: Vec<String>,
    pub(super) ignored: Vec<String>,
}

/// Reads all rows of a table. Without a `run` column they are one run of this name.
pub(super) fn read_rows(table: &Table, mut layout: Layout, run_name: &str) -> Result<Content, CampaignError> {
    let mut reader = table.rows()?;
    let mut record = ByteRecord::new();
    if !table.next(&mut reader, &mut record)? {
        let place = table.header_place();
        return Err(CampaignError::HeaderOnly(Facts::boxed(place, "column names only", "rows below them")));
    }
    let mut cells = Cells { table, record: &record, row: 0 };
    cells.check_count()?;
    let auxiliary = Auxiliary::of(cells, std::mem::take(&mut layout.others), layout.chosen)?;
    let mut runs = Runs::default();
    let mut row = 0;
    loop {
        cells = Cells { table, record: &record, row };
        cells.check_count()?;
        runs.push(cells, &layout, &auxiliary, run_name)?;
        row += 1;
        if !table.next(&mut reader, &mut record)? {
            break;
        }
    }
    let mut ignored = layout.ignored;
    ignored.extend(auxiliary.texts.into_iter().map(|text| text.input.header));
    let channels = auxiliary.channels.into_iter().map(|input| input.name).collect();
    Ok(Content { runs: runs.finish(), channels, ignored })
}

/// The columns without a meaning of their own: numbers are channels, words are left unread.
struct Auxiliary {
    channels: Vec<Input>,
    texts: Vec<Text>,
}

/// A column that holds no number in its first row, and must therefore hold none at all.
struct Text {
    input: Input,
    refused: CampaignError,
}

impl Auxiliary {
    /// The first row tells numbers from words.
    fn of(first: Cells, others: Vec<Input>, chosen: bool) -> Result<Self, CampaignError> {
        let mut auxiliary = Self { channels: Vec::new(), texts: Vec::new() };
        for input in others {
            let expected = if chosen { "a number" } else { "a number, as in rows below it" };
            match first.decimal_or(&input, expected) {
                Ok(_) => auxiliary.channels.push(input),
                Err(refused) if chosen => return Err(refused),
                Err(refused) => auxiliary.texts.push(Text { input, refused }),
            }
        }
        if auxiliary.channels.len() > MAX_CHANNELS {
            let names: Vec<String> = auxiliary.channels.into_iter().map(|input| input.name).collect();
            return Err(CampaignError::too_many_channels(first.table.header_place(), &names));
        }
        Ok(auxiliary)
    }

    fn read(&self, cells: Cells) -> Result<[i64; MAX_CHANNELS], CampaignError> {
        for text in &self.texts {
            // A channel must not vanish because its first value is missing: a column of both is an error.
            if Decimal::parse(cells.raw(&text.input)).is_ok() {
                return Err(text.refused.clone());
            }
        }
        let mut channels = [Sample::NOT_MEASURED; MAX_CHANNELS];
        for (value, input) in channels.iter_mut().zip(&self.channels) {
            *value = cells.micro(input, ANY)?;
        }
        Ok(channels)
    }
}

/// The runs so far. Their rows may be interleaved as long as time advances within each.
#[derive(Default)]
struct Runs {
    runs: Vec<Run>,
    positions: HashMap<String, usize>,
    current: usize,
}

impl Runs {
    fn push(&mut self, cells: Cells, layout: &Layout, auxiliary: &Auxiliary, name: &str) -> Result<(), CampaignError> {
        let name = layout.run.as_ref().map_or(Ok(name), |input| cells.name(input))?;
        let kind = layout.kind.as_ref().map_or(Ok(UNSTATED), |input| kind(cells, input))?;
        let run = self.run(name, kind, cells);
        if let (Some(input), true) = (&layout.kind, run.kind != kind) {
            let expected = format!("{}, as in the rows of {name} above", quoted(run.kind.as_bytes()));
            let facts = Facts::boxed(cells.place(input), quoted(kind.as_bytes()), expected);
            return Err(CampaignError::KindContradiction(facts));
        }
        let mut row = row(cells, layout, auxiliary)?;
        let begins_us = run.rows.first().map_or(row.sample.time_us, |first| first.sample.time_us);
        if layout.power_on.is_none() && begins_us > MAX_UPTIME_US {
            // A calendar's clock does not say when power was applied; a run begins with that.
            row.sample.power_on_us = row.sample.time_us.saturating_sub(begins_us);
        }
        check_time(run, &row.sample, || cells.place(&layout.time))?;
        run.rows.push(row);
        Ok(())
    }

    fn run(&mut self, name: &str, kind: &str, cells: Cells) -> &mut Run {
        let is_current = self.runs.get(self.current).is_some_and(|run| run.name == name);
        if !is_current {
            self.current = self.positions.get(name).copied().unwrap_or(self.runs.len());
        }
        if self.current == self.runs.len() {
            self.positions.insert(name.to_owned(), self.current);
            let source = cells.table.file.clone();
            self.runs.push(Run { name: name.to_owned(), kind: kind.to_owned(), source, rows: Vec::new() });
        }
        &mut self.runs[self.current]
    }

    fn finish(mut self) -> Vec<Run> {
        for run in &mut self.runs {
            run.rows.shrink_to_fit();
        }
        self.runs
    }
}

fn kind<'a>(cells: Cells<'a>, input: &Input) -> Result<&'a str, CampaignError> {
    if cells.raw(input).is_empty() {
        return Ok(UNSTATED);
    }
    let kind = cells.name(input)?;
    Ok(KINDS.into_iter().find(|known| known.eq_ignore_ascii_case(kind)).unwrap_or(kind))
}

fn check_time(run: &Run, sample: &Sample, place: impl Fn() -> Place) -> Result<(), CampaignError> {
    let previous_us = match run.rows.last() {
        Some(previous) if sample.time_us <= previous.sample.time_us => previous.sample.time_us,
        _ => return Ok(()),
    };
    let repeats = if sample.time_us == previous_us { " again" } else { "" };
    let found = format!("{} s{repeats}", micro_text(sample.time_us.into()));
    let expected = format!("more than the {} s of the row before in {}", micro_text(previous_us.into()), run.name);
    Err(CampaignError::TimeNotIncreasing(Facts::boxed(place(), found, expected)))
}

fn row(cells: Cells, layout: &Layout, auxiliary: &Auxiliary) -> Result<Row, CampaignError> {
    let optional = |input: &Option<Input>| input.as_ref().map(|input| cells.micro(input, NOT_NEGATIVE)).transpose();
    let time_us = cells.micro(&layout.time, NOT_NEGATIVE)?;
    let (delta_f_uhz, sum_f_uhz) = signal(cells, layout)?;
    let temperature_uc = cells.micro(&layout.temperature, TEMPERATURE)?;
    let sample = Sample {
        power_on_us: optional(&layout.power_on)?.unwrap_or(time_us),
        age_s: layout.age.as_ref().map(|input| age_s(cells, input)).transpose()?,
        sum_f_uhz,
        channels: auxiliary.read(cells)?,
        ..Sample::from_difference(time_us, delta_f_uhz, temperature_uc)
    };
    let reference_g = cells.real(&layout.reference)?;
    let reference_sigma_g = layout.reference_sigma.as_ref().map(|input| sigma_g(cells, input)).transpose()?;
    Ok(Row { sample, reference_g, reference_sigma_g })
}

/// Difference and sum, µHz.
fn signal(cells: Cells, layout: &Layout) -> Result<(i64, Option<u64>), CampaignError> {
    let (f1, f2, difference) = match &layout.signal {
        Signal::Difference(difference) => {
            let sum = layout.sum.as_ref().map(|sum| cells.micro(sum, NOT_NEGATIVE)).transpose()?;
            return Ok((cells.micro(difference, ANY)?, sum));
        }
        Signal::Pair { f1, f2, difference } => (f1, f2, difference),
    };
    let f1_uhz: u64 = cells.micro(f1, NOT_NEGATIVE)?;
    let f2_uhz: u64 = cells.micro(f2, NOT_NEGATIVE)?;
    let pair = Sample::from_pair(0, f1_uhz, f2_uhz, 0);
    if let Some(difference) = difference {
        check_agreement(cells, difference, pair.delta_f_uhz.into(), [f1, f2], "f1_hz - f2_hz")?;
    }
    if let (Some(sum), Some(sum_f_uhz)) = (&layout.sum, pair.sum_f_uhz) {
        check_agreement(cells, sum, sum_f_uhz.into(), [f1, f2], "f1_hz + f2_hz")?;
    }
    Ok((pair.delta_f_uhz, pair.sum_f_uhz))
}

/// What is stated beside the two frequencies must follow from them, as far as the written digits tell.
fn check_agreement(
    cells: Cells,
    stated: &Input,
    computed_uhz: i128,
    of: [&Input; 2],
    formula: &str,
) -> Result<(), CampaignError> {
    let stated_uhz: i64 = cells.micro(stated, ANY)?;
    if i128::from(stated_uhz) == computed_uhz {
        return Ok(());
    }
    let mut tolerance_uhz = 0.0;
    for input in [stated, of[0], of[1]] {
        tolerance_uhz += input.conversion.step_micro(cells.decimal(input)?) / 2.0;
    }
    if (i128::from(stated_uhz) - computed_uhz).unsigned_abs() as f64 <= tolerance_uhz {
        return Ok(());
    }
    let expected = format!("{formula} = {}", micro_text(computed_uhz));
    let facts = Facts::boxed(cells.place(stated), micro_text(stated_uhz.into()), expected);
    Err(CampaignError::Disagreement(facts))
}

fn age_s(cells: Cells, input: &Input) -> Result<u32, CampaignError> {
    let age_s = (cells.real(input)? * DAY_S).round();
    if (0.0..=f64::from(u32::MAX)).contains(&age_s) { Ok(age_s as u32) } else { Err(cells.out_of_range(input, AGE)) }
}

fn sigma_g(cells: Cells, input: &Input) -> Result<f64, CampaignError> {
    let sigma_g = cells.real(input)?;
    if sigma_g >= 0.0 { Ok(sigma_g) } else { Err(cells.out_of_range(input, "a standard uncertainty, not below 0")) }
}
