//! What a laboratory would do without a network.

use crate::campaign::{Row, Run};
use crate::fit::dataset::InputScale;
use crate::fit::polynomial::Polynomial;
use crate::yardstick::Yardstick;

/// The polynomial in Δf and T with its input scale.
#[derive(Clone, Debug)]
pub struct Baseline {
    /// The polynomial in scaled inputs.
    pub polynomial: Polynomial,
    /// The scale.
    pub scale: InputScale,
}

impl Baseline {
    /// Of the campaign's own units, where this is of the yardstick's.
    pub(super) fn outside(self, yardstick: &Yardstick) -> Self {
        let Self { polynomial, mut scale } = self;
        if yardstick.is_turned() {
            scale.delta_f_zero_uhz = scale.delta_f_zero_uhz.saturating_neg();
        }
        Self { polynomial: polynomial.scaled(yardstick.factor().recip(), yardstick.is_turned()), scale }
    }

    /// Residuals of the polynomial on a run, g.
    #[must_use]
    pub fn residuals_g(&self, run: &Run) -> Vec<f64> {
        let residual = |row: &Row| {
            let [x, t] = self.scale.inputs(&row.sample);
            self.polynomial.evaluate(x, t) - row.reference_g
        };
        run.rows.iter().map(residual).collect()
    }
}
