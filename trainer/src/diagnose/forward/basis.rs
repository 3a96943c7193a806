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

/// How the reading can change by retraining, µg per expected change: polynomials and the network's tangents.
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

/// How the reading of a smooth instrument can change, µg per expected change: polynomials alone.
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
