//! What retraining could make of the static map's reading: polynomials, and the network's derivatives by its weights.

use super::static_map::StaticMap;
use crate::diagnose::cells::{Cell, Cells, Columns, RunCells};
use crate::diagnose::thresholds::{MAP_POWERS, MAP_TANGENTS};
use crate::fit::network::{HIDDEN_SIZE, OUTPUT_SIZE};
use firmware_core::activation::{sigmoid, slope};
use nalgebra::DMatrix;
use protocol::Weights;
use protocol::limits::HIDDEN;
use rayon::prelude::*;

/// How the reading can change by retraining, µg per expected change: polynomials and the network's tangents, of each run
/// cells × directions.
pub fn of_retraining(map: &StaticMap, cells: &Cells) -> Columns {
    let (still, weights) = (cells.is_still(), map.weights());
    let row = |cell: &Cell| {
        if still {
            // The slope is stated, not learnt: retraining can change the course over temperature only.
            return chebyshev(MAP_POWERS.1, cell.t);
        }
        let mut values = polynomials(cell.x, cell.t);
        values.extend(tangents(&weights, cell).map(|value| value * MAP_TANGENTS));
        values
    };
    departures(map, cells, row)
}

/// How the reading of a smooth instrument can change, µg per expected change: polynomials alone, of each run
/// cells × polynomials.
pub fn of_smooth_map(map: &StaticMap, cells: &Cells) -> Columns {
    departures(map, cells, |cell| polynomials(cell.x, cell.t))
}

/// A row of departures from the line in each cell, µg, from those in units of the network's output.
fn departures(map: &StaticMap, cells: &Cells, row: impl Fn(&Cell) -> Vec<f64> + Sync) -> Columns {
    let departure_ug = map.output_ug();
    let of = |run: &RunCells| {
        let rows: Vec<Vec<f64>> = run.cells.iter().map(&row).collect();
        let width = rows.first().map_or(0, Vec::len);
        DMatrix::from_row_iterator(rows.len(), width, rows.into_iter().flatten().map(|value| value * departure_ug))
    };
    cells.runs.par_iter().map(of).collect()
}

/// Derivatives of the reading by the network's weights, each at its expected size.
fn tangents(weights: &Weights, cell: &Cell) -> impl Iterator<Item = f64> {
    let (x, t) = (cell.x, cell.t);
    (0..HIDDEN).flat_map(move |unit| {
        let [wx, wt] = weights.input[unit].map(f64::from);
        let u = f64::from(weights.bias[unit]) + wx * x + wt * t;
        let rise = slope(u) * f64::from(weights.output[unit]) * HIDDEN_SIZE;
        [sigmoid(u) * OUTPUT_SIZE, rise * x, rise * t, rise]
    })
}

/// Chebyshev polynomials of both inputs.
pub fn polynomials(x: f64, t: f64) -> Vec<f64> {
    let (most_x, most_t, most) = MAP_POWERS;
    let (in_x, in_t) = (chebyshev(most_x, x), chebyshev(most_t, t));
    let pairs = (0..=most_x).flat_map(|i| (0..=most_t.min(most - i)).map(move |j| (i, j)));
    pairs.map(|(i, j)| in_x[i] * in_t[j]).collect()
}

fn chebyshev(most: usize, x: f64) -> Vec<f64> {
    let mut values = vec![1.0, x];
    for n in 2..=most {
        values.push(2.0 * x * values[n - 1] - values[n - 2]);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::cells::width;
    use crate::diagnose::example::{Recipe, model, problem};
    use crate::diagnose::problem::scale;
    use firmware_core::Network;

    #[test]
    fn the_polynomials_are_chebyshevs_up_to_their_powers() {
        let angles = [(0.3_f64, 2.0_f64), (1.1, 0.7), (2.9, 1.6)];
        for (a, b) in angles {
            let found = polynomials(a.cos(), b.cos());
            let (most_x, most_t, most) = MAP_POWERS;
            let pairs = (0..=most_x).flat_map(|i| (0..=most_t).map(move |j| (i, j))).filter(|(i, j)| i + j <= most);
            let worked: Vec<f64> = pairs.map(|(i, j)| (i as f64 * a).cos() * (j as f64 * b).cos()).collect();
            assert_eq!(found.len(), worked.len());
            assert!(found.iter().zip(worked).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn the_tangents_are_the_networks_derivatives_by_its_weights() {
        let mut weights = model().weights();
        weights.output = [0.5; HIDDEN];
        weights.input[3] = [-0.75, 1.5];
        weights.bias[3] = -0.25;
        let cell = Cell { x: 0.4, t: -0.6, ..Cell::plain(0, 0.0, 0.0) };
        let found: Vec<f64> = tangents(&weights, &cell).collect();
        assert_eq!(found.len(), 4 * HIDDEN);
        // A step that f32 holds exactly.
        let step = 1.0 / 1024.0_f32;
        for unit in [0, 3] {
            for (part, size) in [(0, OUTPUT_SIZE), (1, HIDDEN_SIZE), (2, HIDDEN_SIZE), (3, HIDDEN_SIZE)] {
                let output = |step: f32| {
                    let mut moved = weights;
                    match part {
                        0 => moved.output[unit] += step,
                        3 => moved.bias[unit] += step,
                        input => moved.input[unit][input - 1] += step,
                    }
                    Network::<f64>::new(&moved).evaluate(cell.x, cell.t)
                };
                let worked = (output(step) - output(-step)) / (2.0 * f64::from(step)) * size;
                let tangent = found[4 * unit + part];
                assert!((tangent - worked).abs() < 1e-5 * size, "{unit} {part}: {tangent} {worked}");
            }
        }
    }

    #[test]
    fn a_map_of_a_still_sensor_may_change_over_temperature_only() {
        let campaign = Recipe { runs: 2, rows: 60, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let map = &problem.forward.map;
        // As if the reading went so far that all these levels were one.
        let still = Cells::new(&campaign, scale(&model()), 1, 1e3, None);
        assert_eq!(width(&of_retraining(map, &still)), MAP_POWERS.1 + 1);
        let all = width(&of_smooth_map(map, problem.cells()));
        assert_eq!(width(&of_retraining(map, problem.cells())), all + 4 * HIDDEN);
        // In µg: the first is a constant, one unit of the network's output.
        let first = of_smooth_map(map, problem.cells());
        assert!(first.iter().all(|run| run.column(0).iter().all(|value| (value - map.output_ug()).abs() < 1e-9)));
    }
}
