//! What retraining could make of the static map's reading, in cells.

use super::basis::polynomials;
use super::contributions::{Contributions, moved};
use super::static_map::StaticMap;
use crate::diagnose::cells::{Cells, Columns, RunCells};
use crate::fit::effects::Contribution;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// The map's scaled inputs in each cell, run by run, as effects move them.
pub type Inputs = Vec<Vec<[f64; 2]>>;

/// The inputs under these contributions.
pub fn inputs(cells: &Cells, contributions: &Contributions) -> Inputs {
    let run = |(run, contributions): (&RunCells, &Vec<Contribution>)| {
        run.cells.iter().zip(contributions).map(|(cell, own)| moved(cells, cell, own)).collect()
    };
    cells.runs.iter().zip(contributions).map(run).collect()
}

/// How the reading can change by retraining, µg per expected change, at these inputs: of each run cells × functions.
pub fn of_retraining(map: &StaticMap, inputs: &Inputs) -> Columns {
    departures(map, inputs, |[x, t]| map.functions(x, t))
}

/// How the reading of a smooth instrument can change, µg per expected change: polynomials alone, of each run
/// cells × polynomials.
pub fn of_smooth_map(map: &StaticMap, cells: &Cells) -> Columns {
    let inputs = cells.runs.iter().map(|run| run.cells.iter().map(|cell| [cell.x, cell.t]).collect()).collect();
    departures(map, &inputs, |[x, t]| polynomials(x, t))
}

/// A row of departures from the line in each cell, µg, from those in units of the network's output.
fn departures(map: &StaticMap, inputs: &Inputs, of: impl Fn([f64; 2]) -> Vec<f64> + Sync) -> Columns {
    let departure_ug = map.output_ug();
    let run = |run: &Vec<[f64; 2]>| {
        let rows: Vec<Vec<f64>> = run.iter().map(|&at| of(at)).collect();
        let width = rows.first().map_or(0, Vec::len);
        DMatrix::from_row_iterator(rows.len(), width, rows.into_iter().flatten().map(|value| value * departure_ug))
    };
    inputs.par_iter().map(run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::cells::width;
    use crate::diagnose::example::{Recipe, effect, model, problem};
    use crate::diagnose::forward::EffectSet;
    use crate::diagnose::thresholds::MAP_POWERS;
    use crate::yardstick::Yardstick;
    use protocol::limits::HIDDEN;

    #[test]
    fn a_map_of_a_still_sensor_may_change_over_temperature_only() {
        let campaign = Recipe { runs: 2, rows: 60, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let map = &problem.forward.map;
        let inputs = problem.forward.inputs(&EffectSet::NONE);
        let yardstick = Yardstick::of_model(&model(), &campaign).unwrap();
        let still = StaticMap::new(&model(), &yardstick).of_still(true);
        assert_eq!(width(&of_retraining(&still, &inputs)), MAP_POWERS.1 + 1);
        let all = width(&of_smooth_map(map, problem.cells()));
        assert_eq!(width(&of_retraining(map, &inputs)), all + 4 * HIDDEN);
        // In µg: the first is a constant, one unit of the network's output.
        let first = of_smooth_map(map, problem.cells());
        assert!(first.iter().all(|run| run.column(0).iter().all(|value| (value - map.output_ug()).abs() < 1e-9)));
    }

    #[test]
    fn an_effect_moves_the_inputs_at_which_the_map_may_change() {
        let campaign = Recipe { runs: 2, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let (none, cells) = (problem.forward.inputs(&EffectSet::NONE), problem.cells());
        assert!(none.iter().flatten().zip(cells.iter()).all(|(at, cell)| *at == [cell.x, cell.t]));
        // A lag holds the temperature back in the first ramp, up in the first run; a bias moves nothing.
        let lag = problem.forward.inputs(&EffectSet::NONE.with(&effect("thermal-lag", &campaign), &[90.0]));
        let of_ramp = cells.runs[0].cells.iter().position(|cell| cell.time_s > 1500.0).unwrap();
        let behind_c = (none[0][of_ramp][1] - lag[0][of_ramp][1]) * cells.scale.temperature_half_span_c;
        assert!((behind_c / 3.0 - 1.0).abs() < 0.15, "90 s at 2 °C/min: {behind_c} °C");
        let bias = EffectSet::NONE.with(&effect("warm-up", &campaign), &[2e-4, 500.0]);
        assert!(problem.forward.inputs(&bias) == none);
    }
}
