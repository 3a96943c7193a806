//! One recording and its rows.

use super::limits;
use protocol::Sample;
use protocol::limits::MAX_CHANNELS;
use std::path::PathBuf;

/// The kind of a run whose file does not say what it was.
pub const UNSTATED: &str = "unstated";

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
    pub(super) fn steps_us(&self) -> impl Iterator<Item = u64> {
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
    pub(super) fn reorder_channels(&mut self, order: &[usize]) {
        for row in &mut self.rows {
            let mut channels = [Sample::NOT_MEASURED; MAX_CHANNELS];
            for (to, &from) in channels.iter_mut().zip(order) {
                *to = row.sample.channels.get(from).copied().unwrap_or(Sample::NOT_MEASURED);
            }
            row.sample.channels = channels;
        }
    }
}
