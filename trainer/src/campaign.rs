//! What was measured: a campaign of runs, each a table of samples with the reference that was applied.
//!
//! ```text
//! files ─table─▶ cells ─columns─▶ layout ─rows─▶ runs ─read─▶ Campaign ─split─▶ training, held out
//! ```
//!
//! Text becomes integers here, once, at the border; nothing behind it parses, rounds or checks again.
//! Data that cannot be trusted is refused with its place, what was found, what was expected, and a way out.

mod cells;
mod check;
mod columns;
mod error;
mod help;
mod limits;
mod nearest;
mod number;
mod options;
mod provenance;
mod read;
mod rows;
mod split;
mod table;
mod text;

#[cfg(test)]
mod bad_campaign;
#[cfg(test)]
mod bad_input;
#[cfg(test)]
mod hostile;
#[cfg(test)]
mod tests;

pub use check::Demand;
pub use error::{CampaignError, Column, Facts, Missing, Place};
pub(crate) use nearest::nearest;
pub use options::{Measured, ReadAs, ReadOptions};
pub use split::{Basis, HoldOut, Split};

use protocol::Sample;
use protocol::limits::MAX_CHANNELS;
use std::path::PathBuf;

/// The kind of a run whose file does not say what it was.
pub const UNSTATED: &str = "unstated";

/// All runs of one sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// The runs, in the order in which the files name them first.
    pub runs: Vec<Run>,
    /// Names of the auxiliary channels, in the order of every row's `sample.channels`.
    pub channels: Vec<String>,
    /// What the signal and the reference are, and in which units.
    pub quantity: Quantity,
    /// Columns of the files that were left unread: text, not selected, or told to be ignored.
    pub ignored_columns: Vec<String>,
    /// How its files were read.
    pub read_as: ReadAs,
    /// Hash of the measured content. It knows nothing of folders, separators or the order of columns.
    pub sha256: [u8; 32],
}

/// One uninterrupted recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its name, unique within the campaign.
    pub name: String,
    /// What it was: `full`, `zero`, `ramp`, `tumble`, `static`, free text, or [`UNSTATED`].
    pub kind: String,
    /// The file that it was read from.
    pub source: PathBuf,
    /// Its rows, in strictly increasing time. A part of a run is a slice of them.
    pub rows: Vec<Row>,
}

/// One instant: what the instrument saw, and what was applied to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The instrument's raw integers.
    pub sample: Sample,
    /// Applied acceleration along the input axis, g (for another quantity, its reference unit).
    pub reference_g: f64,
    /// The rig's own standard uncertainty of that reference, g.
    pub reference_sigma_g: Option<f64>,
}

/// What is measured. Resonant accelerometers come first; a load cell or a resistor is read in the same way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Unit of the signal; `Sample::delta_f_uhz` holds millionths of it.
    pub signal_unit: String,
    /// Unit of the reference.
    pub reference_unit: String,
}

impl Default for Quantity {
    fn default() -> Self {
        Self { signal_unit: "Hz".to_owned(), reference_unit: "g".to_owned() }
    }
}

impl Quantity {
    /// Whether the signal is a frequency, of oscillators that lock and of a counter with a clock.
    #[must_use]
    pub fn is_frequency(&self) -> bool {
        self.signal_unit.ends_with("Hz")
    }
}

impl Campaign {
    /// A campaign of runs that are already in memory. `channels` names the first entries of every
    /// row's `sample.channels`; times within a run increase.
    #[must_use]
    pub fn new(runs: Vec<Run>, channels: Vec<String>, quantity: Quantity) -> Self {
        let sha256 = provenance::sha256(&runs, &channels, &quantity);
        Self { runs, channels, quantity, ignored_columns: Vec::new(), read_as: ReadAs::default(), sha256 }
    }

    /// [`Campaign::sha256`] as text.
    #[must_use]
    pub fn hash(&self) -> String {
        self.sha256.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Every row of every run.
    pub fn rows(&self) -> impl Iterator<Item = &Row> {
        self.runs.iter().flat_map(|run| &run.rows)
    }

    /// Number of rows in all runs.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.runs.iter().map(|run| run.rows.len()).sum()
    }

    /// The distinct reference levels, g, ascending: references within `tolerance_g` of the lowest of
    /// their level are one level, and its middle stands for it.
    #[must_use]
    pub fn levels(&self, tolerance_g: f64) -> Vec<f64> {
        let mut references: Vec<f64> = self.rows().map(|row| row.reference_g).collect();
        references.dedup();
        references.sort_unstable_by(f64::total_cmp);
        let mut levels: Vec<(f64, f64)> = Vec::new();
        for reference_g in references {
            match levels.last_mut() {
                Some((lowest, highest)) if reference_g - *lowest <= tolerance_g => *highest = reference_g,
                _ => levels.push((reference_g, reference_g)),
            }
        }
        levels.into_iter().map(|(lowest, highest)| f64::midpoint(lowest, highest)).collect()
    }

    /// The same campaign with its channels in the order that a model names them; other channels are left out.
    /// The hash stays: it says where the data came from.
    ///
    /// # Errors
    /// [`CampaignError::MissingChannel`] if the campaign lacks one of `names`,
    /// [`CampaignError::TooManyChannels`] if a sample cannot hold that many.
    pub fn arranged(&self, names: &[&str]) -> Result<Self, CampaignError> {
        let order = names.iter().map(|name| self.channel(name)).collect::<Result<Vec<_>, _>>()?;
        if order.len() > MAX_CHANNELS {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            return Err(CampaignError::too_many_channels(Place::campaign(), &names));
        }
        let mut arranged = self.clone();
        arranged.channels = names.iter().map(|&name| name.to_owned()).collect();
        for run in &mut arranged.runs {
            run.reorder_channels(&order);
        }
        Ok(arranged)
    }

    fn channel(&self, name: &str) -> Result<usize, CampaignError> {
        self.channels.iter().position(|channel| channel == name).ok_or_else(|| CampaignError::MissingChannel {
            facts: Facts::boxed(
                Place::campaign(),
                error::list("channels", &self.channels),
                format!("a channel {name}"),
            ),
            channel: name.to_owned(),
            nearest: nearest(name, &self.channels),
        })
    }
}

/// Across this many sampling intervals, what a sensor remembers is carried.
const GAP_INTERVALS: f64 = 30.0;

impl Campaign {
    /// How long nobody may look before what the sensor remembers counts as lost, µs: many regular intervals, and the
    /// longest pause within a run, as a run is one course of events whose soaks need not be recorded.
    #[must_use]
    pub fn max_gap_us(&self) -> u32 {
        let slowest_s = self.runs.iter().filter_map(Run::sample_interval_s).fold(1.0, f64::max);
        let longest_us = self.runs.iter().flat_map(Run::steps_us).max().unwrap_or_default();
        (slowest_s * GAP_INTERVALS * 1e6).max(longest_us as f64).min(f64::from(u32::MAX)) as u32
    }
}

impl Run {
    /// Time from the first row to the last, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (self.rows.first(), self.rows.last()) {
            (Some(first), Some(last)) => last.sample.time_us.saturating_sub(first.sample.time_us) as f64 * 1e-6,
            _ => 0.0,
        }
    }

    /// Whether the clock is a calendar's (Unix time, for example), which does not say when power was applied: unless
    /// the file has a column `power_on_s`, time since power-on is counted from the first row.
    #[must_use]
    pub fn has_calendar_time(&self) -> bool {
        self.rows.first().is_some_and(|first| first.sample.time_us > limits::MAX_UPTIME_US)
    }

    /// Whether the first row is taken to be the moment at which power was applied.
    #[must_use]
    pub fn begins_with_power_on(&self) -> bool {
        self.rows.first().is_some_and(|first| first.sample.power_on_us == 0)
    }

    /// Times between rows, µs.
    fn steps_us(&self) -> impl Iterator<Item = u64> {
        self.rows.windows(2).map(|pair| pair[1].sample.time_us.saturating_sub(pair[0].sample.time_us))
    }

    /// Median time between rows, s; `None` of a run with fewer than two rows.
    #[must_use]
    pub fn sample_interval_s(&self) -> Option<f64> {
        let mut steps_us: Vec<u64> = self.steps_us().collect();
        if steps_us.is_empty() {
            return None;
        }
        let middle = steps_us.len() / 2;
        let (_, median_us, _) = steps_us.select_nth_unstable(middle);
        Some(*median_us as f64 * 1e-6)
    }

    /// The rows from `start_us` on and before `end_us`, without copying.
    #[must_use]
    pub fn between(&self, start_us: u64, end_us: u64) -> &[Row] {
        let start = self.rows.partition_point(|row| row.sample.time_us < start_us);
        let end = self.rows.partition_point(|row| row.sample.time_us < end_us).max(start);
        self.rows.get(start..end).unwrap_or_default()
    }

    /// Entry `i` of every row's channels becomes what was entry `order[i]`; the rest was not measured.
    fn reorder_channels(&mut self, order: &[usize]) {
        for row in &mut self.rows {
            let mut channels = [Sample::NOT_MEASURED; MAX_CHANNELS];
            for (to, &from) in channels.iter_mut().zip(order) {
                *to = row.sample.channels.get(from).copied().unwrap_or(Sample::NOT_MEASURED);
            }
            row.sample.channels = channels;
        }
    }
}
