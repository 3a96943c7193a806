//! What a reader should know before believing the figures.

use crate::campaign::{Campaign, Row};
use crate::metrics::levels::{level_width, span};
use crate::noise::rms;
use crate::residuals::{Residuals, RunResiduals};
use crate::sensitivity::Sensitivity;

/// With fewer levels than this, what lies between them was never measured.
const LEVELS_MIN: usize = 5;
/// References closer than this part of what all of them span are one level.
const SAME_LEVEL: f64 = 0.025;
/// So are any closer than so many residuals.
const SAME_RESIDUALS: f64 = 4.0;
/// Temperatures further apart than this leave a gap in which a narrow effect can hide, °C.
const GAP_C: f64 = 12.0;
/// A slope further off than this betrays a network that learnt levels by heart, ppm.
const SLOPE_WORST_PPM: f64 = 1000.0;

/// Warnings for a comparison, each a sentence with what to do.
#[must_use]
pub fn warnings(campaign: &Campaign, residuals: &Residuals, sensitivity: Option<&Sensitivity>) -> Vec<String> {
    [few_levels(campaign, residuals), gaps(campaign), below_reference(residuals), slope(sensitivity)]
        .into_iter()
        .flatten()
        .collect()
}

fn few_levels(campaign: &Campaign, residuals: &Residuals) -> Option<String> {
    let references: Vec<f64> = campaign.rows().map(|row| row.reference_g).collect();
    let residual_g = rms(residuals.runs.iter().flat_map(|run| &run.residuals_g));
    let width_g = level_width(&references).max(SAME_LEVEL * span(&references)).max(SAME_RESIDUALS * residual_g);
    let levels = campaign.levels(width_g).len();
    (levels < LEVELS_MIN).then(|| {
        format!(
            "the campaign has only {levels} levels of acceleration: nothing here measures the model between them; \
             record a tumble of 12 or 24 positions"
        )
    })
}

fn gaps(campaign: &Campaign) -> Option<String> {
    let mut temperatures: Vec<f64> =
        campaign.rows().map(|row: &Row| f64::from(row.sample.temperature_uc) * 1e-6).collect();
    temperatures.sort_by(f64::total_cmp);
    let gap = temperatures.windows(2).map(|pair| (pair[1] - pair[0], pair[0])).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (gap.0 > GAP_C).then(|| {
        format!(
            "no sample between {:.0} and {:.0} °C: an effect narrower than that would not be seen; record a slow ramp",
            gap.1,
            gap.1 + gap.0
        )
    })
}

/// A residual below the rig's own uncertainty says that the model learnt the rig.
fn below_reference(residuals: &Residuals) -> Option<String> {
    let too_good = |run: &&RunResiduals| {
        let variances = run.run.rows.iter().filter_map(|row| row.reference_sigma_g).map(|sigma| sigma * sigma);
        let (sum, count) = variances.fold((0.0, 0_u32), |(sum, count), variance| (sum + variance, count + 1));
        count > 0 && run.rms_g() < (sum / f64::from(count)).sqrt()
    };
    let run = residuals.runs.iter().find(too_good)?;
    Some(format!(
        "run {}: the residual of {:.2} µg is below the stated uncertainty of its reference: the model may have learnt \
         the errors of the rig",
        run.run.name,
        run.rms_g() * 1e6
    ))
}

fn slope(sensitivity: Option<&Sensitivity>) -> Option<String> {
    let worst = sensitivity?.worst;
    (worst > SLOPE_WORST_PPM).then(|| {
        format!(
            "the local slope is off by up to {worst:.0} ppm of the measured scale factor: between the trained levels \
             this model does not measure acceleration; train with the default method"
        )
    })
}
