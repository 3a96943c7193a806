//! Whether a campaign can teach anything.

use super::Campaign;
use super::error::{CampaignError, Facts, Place};
use super::number::micro_text;
use super::run::Row;

/// References within this part of their size are the same number, written differently.
const SAME_REFERENCE: f64 = 1e-9;
/// A signal that spans fewer millionths of its unit than this is spoilt by rounding to them.
const SIGNAL_STEPS: u64 = 100;

/// What training needs of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Demand {
    /// Rows in all runs together.
    pub rows_min: usize,
    /// Whether the scale factor is known from elsewhere, so that the reference need not vary.
    pub scale_factor_stated: bool,
    /// Whether a campaign of one run will do: nothing is to be held out.
    pub one_run_will_do: bool,
}

impl Campaign {
    /// Checks that a model can be fitted to this campaign and judged on it. Comparing needs none of this.
    ///
    /// # Errors
    /// [`CampaignError::OneRun`], [`CampaignError::TooFewRows`], [`CampaignError::ConstantColumn`],
    /// [`CampaignError::TooCoarse`] or [`CampaignError::ConstantReference`].
    pub fn check_trainable(&self, demand: &Demand) -> Result<(), CampaignError> {
        if self.runs.len() < 2 && !demand.one_run_will_do {
            return Err(self.one_run());
        }
        let rows = self.row_count();
        if rows < demand.rows_min {
            let (found, expected) = (format!("{rows} rows"), format!("at least {}", demand.rows_min));
            return Err(CampaignError::TooFewRows(Facts::boxed(Place::campaign(), found, expected)));
        }
        self.check_varies("temperature_c", |row| row.sample.temperature_uc.into())?;
        let steps = self.check_varies("delta_f_hz", |row| row.sample.delta_f_uhz)?;
        if steps < SIGNAL_STEPS {
            let place = Place::campaign().column(None, "delta_f_hz");
            let found = format!("a signal that spans {steps} millionths of a {}", self.quantity.signal_unit);
            let expected = format!("{SIGNAL_STEPS} or more, because it is kept as a whole number of them");
            return Err(CampaignError::TooCoarse(Facts::boxed(place, found, expected)));
        }
        if demand.scale_factor_stated { Ok(()) } else { self.check_reference() }
    }

    /// Nothing can be held out of a single run.
    pub(super) fn one_run(&self) -> CampaignError {
        let found = self.runs.first().map_or("no run".to_owned(), |run| format!("one run ({})", run.name));
        CampaignError::OneRun(Facts::boxed(Place::campaign(), found, "two runs or more, to hold one out"))
    }

    /// How far a column spans, in millionths; an error if it does not.
    fn check_varies(&self, column: &str, value: impl Fn(&Row) -> i64) -> Result<u64, CampaignError> {
        let (lowest, highest) =
            self.rows().map(value).fold((i64::MAX, i64::MIN), |(low, high), value| (low.min(value), high.max(value)));
        if lowest < highest {
            return Ok(highest.abs_diff(lowest));
        }
        let found = format!("{} in all {} rows", micro_text(lowest.into()), self.row_count());
        let place = Place::campaign().column(None, column);
        Err(CampaignError::ConstantColumn(Facts::boxed(place, found, "values that vary")))
    }

    fn check_reference(&self) -> Result<(), CampaignError> {
        let (lowest, highest) = self
            .rows()
            .map(|row| row.reference_g)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if highest - lowest > SAME_REFERENCE * highest.abs().max(lowest.abs()) {
            return Ok(());
        }
        let found = format!("{lowest} {} in all {} rows", self.quantity.reference_unit, self.row_count());
        let place = Place::campaign().column(None, "reference_g");
        Err(CampaignError::ConstantReference(Facts::boxed(place, found, "a reference that varies")))
    }
}
