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
mod limits;
mod mapping;
mod nearest;
mod number;
mod options;
mod provenance;
mod quantity;
mod read;
mod rows;
mod run;
mod split;
mod table;
mod text;

#[cfg(test)]
mod bad_campaign;
#[cfg(test)]
mod bad_input;
#[cfg(test)]
mod edges;
#[cfg(test)]
mod hostile;
#[cfg(test)]
mod tests;

pub use check::Demand;
pub use error::{CampaignError, Column, Facts, Missing, Place};
pub(crate) use nearest::nearest;
pub use options::{Measured, ReadAs, ReadOptions};
pub use quantity::Quantity;
pub use run::{Row, Run, UNSTATED};
pub use split::{Basis, HoldOut, Split};

use protocol::limits::MAX_CHANNELS;

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
