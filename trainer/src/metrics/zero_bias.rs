//! Zero-bias stability (Huang et al. 2022, Table 1).

use super::standard_deviation;
use crate::campaign::Run;
use serde::Serialize;

/// What the figures mean.
pub const DEFINITION: &str = "zero-bias stability = standard deviation (n − 1) of the samples at their own rate over \
    a recording at 0 g, from power-on, after 20 and after 30 minutes (Huang et al. 2022, Table 1). It is blind to a \
    constant error, and it is not the bias instability of an Allan plot.";

/// Zero-bias stability of one run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ZeroBias {
    /// From the first sample, µg.
    pub from_start_ug: f64,
    /// From 20 minutes after power-on, µg.
    pub after_20_min_ug: f64,
    /// From 30 minutes after power-on, µg.
    pub after_30_min_ug: f64,
}

/// A recording must go on for this long after the last starting point, s.
const LEAST_TAIL_S: f64 = 600.0;

/// The figures of `outputs_g`, one of each row; `None` unless the run is of kind `zero` and long enough.
#[must_use]
pub fn zero_bias(run: &Run, outputs_g: &[f64]) -> Option<ZeroBias> {
    let power_on_s = |index: usize| run.rows.get(index).map(|row| row.sample.power_on_us as f64 * 1e-6);
    let last_s = power_on_s(run.rows.len().checked_sub(1)?)?;
    if run.kind != "zero" || last_s < 1800.0 + LEAST_TAIL_S {
        return None;
    }
    let after_ug = |start_s: f64| {
        let kept: Vec<f64> = outputs_g
            .iter()
            .enumerate()
            .filter(|(index, _)| power_on_s(*index).is_some_and(|time| time >= start_s))
            .map(|(_, output)| *output)
            .collect();
        standard_deviation(&kept) * 1e6
    };
    Some(ZeroBias {
        from_start_ug: after_ug(0.0),
        after_20_min_ug: after_ug(1200.0),
        after_30_min_ug: after_ug(1800.0),
    })
}
