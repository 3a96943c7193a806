//! Residuals of states in the order in which they were recorded.

use super::chart::{Axis, Chart, Layer, Tone};
use super::residual_charts::residual_axis;
use super::samples::RunName;
use super::thin::thin;
use crate::metrics::mean;
use crate::metrics::states::states;
use crate::residuals::Residuals;

/// A state with fewer rows than this has no mean.
const LEAST_ROWS: usize = 3;

/// One mark a state: drifts from run to run, and states that the table or the soak spoilt.
#[must_use]
pub fn order_chart(runs: &[RunName], residuals: &Residuals) -> Option<Chart> {
    let all: Vec<(u16, f64)> = residuals
        .runs
        .iter()
        .enumerate()
        .flat_map(|(index, run)| {
            let of_state = move |rows: std::ops::Range<usize>| run.residuals_g.get(rows).map(mean);
            states(run.run)
                .into_iter()
                .filter(|state| state.rows.len() >= LEAST_ROWS)
                .filter_map(move |state| Some((u16::try_from(index).ok()?, of_state(state.rows)? * 1e6)))
        })
        .collect();
    if all.len() < 2 {
        return None;
    }
    let x = Axis::linear("state, in the order of recording", "", [1.0, all.len() as f64]);
    let y = residual_axis(all.iter().map(|(_, residual_ug)| *residual_ug));
    let layer = |name: &str, tone: Tone, held_out: bool| {
        let belongs = |run: u16| runs.get(usize::from(run)).is_some_and(|run| run.held_out) == held_out;
        let members: Vec<(f64, f64, u16)> = all
            .iter()
            .enumerate()
            .filter(|(_, (run, _))| belongs(*run))
            .map(|(place, (run, residual_ug))| ((place + 1) as f64, *residual_ug, *run))
            .collect();
        let parts: Vec<[f64; 2]> = members.iter().map(|(place, value, _)| [x.part(*place), y.part(*value)]).collect();
        let kept = thin(&parts);
        (!kept.is_empty()).then(|| Layer::Dots {
            name: name.to_owned(),
            tone,
            x: kept.iter().map(|&k| members[k].0).collect(),
            y: y.all_rounded(kept.iter().map(|&k| members[k].1)),
            run: kept.iter().map(|&k| members[k].2).collect(),
        })
    };
    let layers = [layer("training", Tone::Quiet, false), layer("held out", Tone::First, true)];
    Some(Chart {
        id: "residual-order".to_owned(),
        title: "Residual of each state, in order".to_owned(),
        caption:
            "Mean over each stretch at one level and one temperature, run after run. Steps between runs are turn-on \
                  or mounting; a course within a run is a drift; single outliers are the table or too short a soak."
                .to_owned(),
        x,
        y,
        layers: layers.into_iter().flatten().collect(),
    })
}
