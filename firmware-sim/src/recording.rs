//! What a campaign recorded, with the truth beside every row for those who judge.
//!
//! Apart from the twin because it is data: what is written out is the instrument's side only.

use std::io;

use crate::twin::noise_floor::NoiseFloor;
use crate::twin::static_map::StaticMap;
use crate::twin::truth::Truth;

mod column;
mod csv;
mod row;

pub use column::Column;
pub(crate) use row::micro;
pub use row::{RecordedRun, Row, RowTruth};

/// All runs of a simulated campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name of the scenario.
    pub scenario: String,
    /// The device that was measured.
    pub device: Truth,
    /// The optional columns that are written.
    pub columns: Vec<Column>,
    /// The runs in order of time.
    pub runs: Vec<RecordedRun>,
}

impl Recording {
    /// Number of samples.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.runs.iter().map(|run| run.rows.len()).sum()
    }

    /// The device without effects as a function, with its exact inverse: the perfect static compensation.
    #[must_use]
    pub fn static_map(&self) -> StaticMap {
        StaticMap::new(&self.device)
    }

    /// The residual of a perfect static compensation over all rows, by parts.
    #[must_use]
    pub fn noise_floor(&self) -> NoiseFloor {
        NoiseFloor::mean(self.runs.iter().flat_map(|run| &run.rows).map(|row| row.truth.floor))
    }

    /// Root mean square of the residual that noise alone leaves behind a perfect static compensation, µg. Errors of the
    /// rig and the turn-on bias are not in it: see [`NoiseFloor::setup_ug`].
    #[must_use]
    pub fn noise_floor_ug(&self) -> f64 {
        self.noise_floor().noise_ug()
    }

    /// Writes the whole campaign as one table.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write_csv(&self, out: &mut impl io::Write) -> io::Result<()> {
        csv::write(out, &self.columns, &self.runs)
    }

    /// Writes one run as a table of its own, in the same columns.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write_run_csv(&self, run: &RecordedRun, out: &mut impl io::Write) -> io::Result<()> {
        csv::write(out, &self.columns, std::slice::from_ref(run))
    }
}
