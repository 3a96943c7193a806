//! A recording at rest, raw and compensated (Huang et al. 2022, Figure 7).

use super::chart::{Axis, Chart, Layer, Tone};
use super::raw_line::RawLine;
use super::samples::RunName;
use super::thin::thin;
use crate::metrics::levels::level_width;
use crate::metrics::mean;
use crate::residuals::{Residuals, RunResiduals};

/// The longest zero-bias run that was held out, or of all where none was; else another recording at one level.
#[must_use]
pub fn zero_chart(runs: &[RunName], residuals: &Residuals, line: &RawLine) -> Option<Chart> {
    let rows = residuals.runs.iter().flat_map(|run| &run.run.rows);
    let width_g = level_width(&rows.map(|row| row.reference_g).collect::<Vec<_>>());
    let any_held_out = runs.iter().any(|run| run.held_out);
    let counts = |(name, run): &(&RunName, &RunResiduals)| (name.held_out || !any_held_out) && at_rest(run, width_g);
    let candidates = runs.iter().zip(&residuals.runs).filter(counts);
    let (_, run) = candidates.max_by_key(|(name, run)| (name.kind == "zero", run.residuals_g.len()))?;
    let raw_ug = about_mean_ug(&line.residuals_g(run.run));
    let compensated_ug = about_mean_ug(&run.residuals_g);
    let minutes = minutes(run);
    let x = Axis::linear("time since power-on", "min", minutes.iter().copied());
    let y = Axis::linear("output less its mean", "µg", raw_ug.iter().chain(&compensated_ug).copied());
    let layer = |name: &str, tone: Tone, values: &[f64]| {
        let parts: Vec<[f64; 2]> =
            minutes.iter().zip(values).map(|(time, value)| [x.part(*time), y.part(*value)]).collect();
        let kept = thin(&parts);
        Layer::Dots {
            name: name.to_owned(),
            tone,
            x: x.all_rounded(kept.iter().map(|&k| minutes[k])),
            y: y.all_rounded(kept.iter().map(|&k| values[k])),
            run: Vec::new(),
        }
    };
    Some(Chart {
        id: "zero-bias".to_owned(),
        title: "At rest, raw and compensated".to_owned(),
        caption: format!("Run {}. The mean of each is taken off, as in the literature.", run.run.name),
        layers: vec![layer("raw", Tone::Second, &raw_ug), layer("compensated", Tone::First, &compensated_ug)],
        x,
        y,
    })
}

/// At one level from beginning to end.
fn at_rest(run: &RunResiduals, width_g: f64) -> bool {
    let mut levels = run.run.rows.iter().map(|row| row.reference_g);
    let Some(first) = levels.next() else { return false };
    (run.run.kind == "zero" || run.run.kind == "static") && levels.all(|level| (level - first).abs() <= width_g)
}

fn about_mean_ug(values_g: &[f64]) -> Vec<f64> {
    let middle = mean(values_g);
    values_g.iter().map(|value| (value - middle) * 1e6).collect()
}

fn minutes(run: &RunResiduals) -> Vec<f64> {
    run.run.rows.iter().map(|row| row.sample.power_on_us as f64 / 60e6).collect()
}
