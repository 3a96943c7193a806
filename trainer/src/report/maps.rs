//! Two maps over frequency difference and temperature: what is left, and how true the slope is.

use super::chart::{Axis, Chart, Layer};
use super::samples::{RunName, Sample};
use crate::campaign::Campaign;
use crate::model::Model;
use crate::sensitivity::SlopeError;

/// Columns and rows: few enough that each cell can bear its number.
const COLUMNS: usize = 12;
const ROWS: usize = 12;
/// Fewer samples than this are no mean.
const CELL_LEAST: usize = 5;
/// Points of a cell at each of which the slope is looked at, along each side.
const LOOKS: usize = 4;

/// A grid over the two inputs.
struct Grid {
    x: [f64; 2],
    y: [f64; 2],
}

impl Grid {
    fn edges([low, high]: [f64; 2], count: usize) -> Vec<f64> {
        (0..=count).map(|k| low + (high - low) * k as f64 / count as f64).collect()
    }

    fn slot([low, high]: [f64; 2], value: f64, count: usize) -> usize {
        (((value - low) / (high - low) * count as f64).max(0.0) as usize).min(count - 1)
    }

    fn layer(&self, name: &str, unit: &str, values: Vec<Option<f64>>) -> Layer {
        let limit = values.iter().flatten().map(|value| value.abs()).fold(f64::MIN_POSITIVE, f64::max);
        let axis = Axis::linear(name, unit, [-limit, limit]);
        Layer::Map {
            name: name.to_owned(),
            unit: unit.to_owned(),
            x_edges: Self::edges(self.x, COLUMNS),
            y_edges: Self::edges(self.y, ROWS),
            values: values.into_iter().map(|value| value.map(|value| axis.rounded(value))).collect(),
            limit,
        }
    }
}

/// Bounds of the calibrated domain in Hz and °C.
fn domain(model: &Model) -> ([f64; 2], [f64; 2]) {
    (model.domain.delta_f_uhz.map(|uhz| uhz as f64 * 1e-6), model.domain.temperature_uc.map(|uc| f64::from(uc) * 1e-6))
}

fn axes(x: [f64; 2], y: [f64; 2]) -> (Axis, Axis) {
    (Axis::linear("frequency difference Δf", "Hz", x), Axis::linear("temperature", "°C", y))
}

fn outline(model: &Model) -> Layer {
    let (x, y) = domain(model);
    Layer::Outline { name: "calibrated domain".to_owned(), x, y }
}

/// Mean residual of each cell: of the held-out runs, or of all where none is.
#[must_use]
pub fn residual_map(model: &Model, runs: &[RunName], samples: &[Sample]) -> Chart {
    let any_held_out = runs.iter().any(|run| run.held_out);
    let counts = |sample: &&Sample| !any_held_out || runs.get(usize::from(sample.run)).is_some_and(|run| run.held_out);
    let counted: Vec<&Sample> = samples.iter().filter(counts).collect();
    let (domain_x, domain_y) = domain(model);
    let hull = |values: [f64; 2], of: fn(&Sample) -> f64| {
        counted.iter().fold(values, |[low, high], sample| [low.min(of(sample)), high.max(of(sample))])
    };
    let grid = Grid { x: hull(domain_x, |sample| sample.delta_f_hz), y: hull(domain_y, |sample| sample.temperature_c) };
    let mut cells = vec![(0_usize, 0.0); COLUMNS * ROWS];
    for sample in &counted {
        let column = Grid::slot(grid.x, sample.delta_f_hz, COLUMNS);
        let cell = &mut cells[Grid::slot(grid.y, sample.temperature_c, ROWS) * COLUMNS + column];
        *cell = (cell.0 + 1, cell.1 + sample.residual_ug);
    }
    let values = cells.into_iter().map(|(count, sum)| (count >= CELL_LEAST).then(|| sum / count as f64)).collect();
    let (x, y) = axes(grid.x, grid.y);
    let which = if any_held_out { "the held-out runs" } else { "all runs" };
    Chart {
        id: "residual-map".to_owned(),
        title: "Residual over frequency difference and temperature".to_owned(),
        caption: format!(
            "Mean residual of {which} in each cell, µg; an empty cell holds fewer than {CELL_LEAST} samples. Outside the \
             dotted line readings are flagged as extrapolated."
        ),
        x,
        y,
        layers: vec![grid.layer("mean residual", "µg", values), outline(model)],
    }
}

/// The worst error of the local slope in each cell of the domain; `None` where no scale factor was measured.
#[must_use]
pub fn sensitivity_map(model: &Model, campaign: &Campaign) -> Option<Chart> {
    let error = SlopeError::new(model, campaign)?;
    let (x, y) = domain(model);
    let grid = Grid { x, y };
    let at = |[low, high]: [f64; 2], cell: usize, look: usize, cells: usize| {
        low + (high - low) * (cell as f64 + look as f64 / LOOKS as f64) / cells as f64
    };
    let worst = |cell: usize| {
        let (column, row) = (cell % COLUMNS, cell / COLUMNS);
        let looks = (0..=LOOKS).flat_map(|i| (0..=LOOKS).map(move |j| (i, j)));
        looks
            .map(|(i, j)| error.ppm_at(at(x, column, i, COLUMNS) * 1e6, at(y, row, j, ROWS) * 1e6))
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
    };
    let values = (0..COLUMNS * ROWS).map(worst).collect();
    let (x, y) = axes(grid.x, grid.y);
    Some(Chart {
        id: "sensitivity-map".to_owned(),
        title: "Error of the local slope".to_owned(),
        caption:
            "How far the slope of the model is from the measured scale factor; each cell shows its worst value, ppm. \
                  A model that learnt levels by heart is off by thousands."
                .to_owned(),
        x,
        y,
        layers: vec![grid.layer("slope error", "ppm", values)],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_on_the_border_belongs_to_the_outermost_cell() {
        let slots = [-40.0, -39.9, 10.0, 59.9, 60.0].map(|value| Grid::slot([-40.0, 60.0], value, 10));
        assert_eq!(slots, [0, 0, 5, 9, 9]);
        assert_eq!(Grid::edges([-40.0, 60.0], 4), [-40.0, -15.0, 10.0, 35.0, 60.0]);
    }
}
