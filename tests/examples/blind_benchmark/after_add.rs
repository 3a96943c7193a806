//! Whether adding what was found helps as much as adding what is hidden.

use crate::case::Case;
use crate::options::Options;
use firmware_core::effect::about;
use serde::Serialize;
use trainer::campaign::HoldOut;
use trainer::compare::{Comparison, compare};
use trainer::diagnose::Diagnosis;
use trainer::progress::Quiet;
use trainer::train::{EffectChoice, TrainSettings, train};

/// Held-out residuals of two models, µg; about the mean of each run where every run has an offset of its own.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AfterAdd {
    /// With the effects that were found.
    pub found_ug: f64,
    /// With the effects that are hidden.
    pub true_ug: f64,
}

impl AfterAdd {
    pub fn ratio(&self) -> f64 {
        self.found_ug / self.true_ug
    }
}

/// `None` where the truth is not one that a model can contain, or a training failed.
pub fn compared(options: &Options, case: &Case, diagnosis: &Diagnosis) -> Option<AfterAdd> {
    let on_device = |name: &&str| about(name).is_some_and(firmware_core::effect::About::is_on_device);
    let hidden: Vec<&str> = case.hidden.iter().map(|hidden| hidden.name.as_str()).collect();
    if hidden.is_empty() || !hidden.iter().all(on_device) {
        return None;
    }
    let found: Vec<&str> = diagnosis.findings.iter().map(|finding| finding.effect.as_str()).filter(on_device).collect();
    Some(AfterAdd { found_ug: held_out_ug(options, case, &found)?, true_ug: held_out_ug(options, case, &hidden)? })
}

fn held_out_ug(options: &Options, case: &Case, effects: &[&str]) -> Option<f64> {
    let split = case.campaign.split(&HoldOut::LastOfEachKind).ok()?;
    let settings = TrainSettings {
        restarts: options.restarts,
        effects: effects.iter().map(|name| EffectChoice::named(name)).collect(),
        ..TrainSettings::new(case.seed)
    };
    let model = train(&case.campaign, &split, &settings, &Quiet).ok()?.model;
    let comparison = compare(&model, &case.campaign).ok()?;
    Some(if case.rig { about_means_ug(&comparison) } else { comparison.residual_ug })
}

fn about_means_ug(comparison: &Comparison) -> f64 {
    let held_out = comparison.runs.iter().filter(|run| run.held_out);
    let (squares, samples) = held_out.fold((0.0, 0.0), |(squares, samples), run| {
        let weight = run.samples as f64;
        (squares + weight * run.about_mean_ug.powi(2), samples + weight)
    });
    (squares / samples).sqrt()
}
