//! Figures of merit before and after compensation, each with its definition.

use crate::compare::{Comparison, Figures, RunFigures};
use crate::metrics::full_temperature::{self, FullTemperature};
use crate::metrics::stability::{Definition, StabilityFigure};
use serde::Serialize;

/// One figure, before and after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Merit {
    /// What it is called.
    pub name: String,
    /// What is computed.
    pub definition: String,
    /// Its unit.
    pub unit: String,
    /// The run that it was computed from; `None` of all runs that count.
    pub run: Option<String>,
    /// Whether the training never saw those rows.
    pub held_out: bool,
    /// Of the raw frequency difference, by a straight line.
    pub raw: f64,
    /// Of the compensated reading.
    pub compensated: f64,
}

/// All figures: of the runs that were held out, or of all where none was.
#[must_use]
pub fn merits(comparison: &Comparison, raw_residual_ug: f64) -> Vec<Merit> {
    let residual = Merit {
        name: "Residual".to_owned(),
        definition: "root mean square of reading minus reference over all rows that count".to_owned(),
        unit: "µg".to_owned(),
        run: None,
        held_out: comparison.held_out,
        raw: raw_residual_ug,
        compensated: comparison.residual_ug,
    };
    let counted = || comparison.figures.iter().filter(|run| run.held_out || !comparison.held_out);
    std::iter::once(residual).chain(counted().flat_map(stability)).chain(counted().flat_map(over_temperature)).collect()
}

fn stability(run: &RunFigures) -> Vec<Merit> {
    let (Some(raw), Some(compensated)) = (&run.raw.stability, &run.compensated.stability) else { return Vec::new() };
    let pairs = raw.figures.iter().zip(&compensated.figures);
    let merit = |(raw, compensated): (&StabilityFigure, &StabilityFigure)| {
        let Definition { id, what } = raw.definition;
        of_run(run, id, what, "µg", [raw.value_ug, compensated.value_ug])
    };
    pairs.map(merit).collect()
}

/// One of the figures over temperature.
type Figure = fn(&FullTemperature) -> f64;

fn over_temperature(run: &RunFigures) -> Vec<Merit> {
    let get = |figures: &Figures, value: Figure| figures.full_temperature.as_ref().map(value);
    let all: [(&str, &str, Figure); 4] = [
        ("Variation of scale factor", "ppm", |figures| figures.scale_factor_variation_ppm),
        ("Slope of scale factor", "ppm/K", |figures| figures.scale_factor_temperature_sensitivity_ppm_per_k),
        ("Variation of bias", "µg", |figures| figures.bias_variation_ug),
        ("Slope of bias", "µg/K", |figures| figures.bias_temperature_sensitivity_ug_per_k),
    ];
    let merit = |(name, unit, value): (&str, &str, Figure)| {
        let pair = [get(&run.raw, value)?, get(&run.compensated, value)?];
        Some(of_run(run, name, full_temperature::DEFINITION, unit, pair))
    };
    all.into_iter().filter_map(merit).collect()
}

fn of_run(run: &RunFigures, name: &str, definition: &str, unit: &str, [raw, compensated]: [f64; 2]) -> Merit {
    Merit {
        name: name.to_owned(),
        definition: definition.to_owned(),
        unit: unit.to_owned(),
        run: Some(run.run.clone()),
        held_out: run.held_out,
        raw,
        compensated,
    }
}
