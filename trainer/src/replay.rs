//! The one evaluation of a deployed model: blob and run in, readings out.

use crate::campaign::Run;
use firmware_core::{Compensator, LoadError};
use protocol::{Blob, Reading};

/// The readings that a device with this calibration gives for the run's samples, bit for bit.
///
/// # Errors
/// [`LoadError`] if the core refuses the blob.
pub fn replay(blob: &Blob, run: &Run) -> Result<Vec<Reading>, LoadError> {
    let mut compensator = Compensator::load(blob)?;
    Ok(run.rows.iter().map(|row| compensator.compensate(&row.sample)).collect())
}
