//! The static map as it is modelled now, in cells: what it reads wrong.

use super::basis;
use super::contributions::{Contributions, moved};
use crate::diagnose::cells::{Cell, Cells, Columns, RunCells};
use crate::fit::effects::Contribution;
use crate::model::Model;
use crate::noise::rms;
use crate::yardstick::Yardstick;
use firmware_core::{Network, Scale};
use nalgebra::DMatrix;
use protocol::Weights;
use rayon::prelude::*;

/// g to µg.
const UG: f64 = 1e6;

/// The static map: what a model computes without its effects.
#[derive(Clone)]
pub struct StaticMap {
    model: Model,
    weights: Weights,
    network: Network<f64>,
    scale: Scale<f64>,
    /// What its readings are multiplied with.
    factor: f64,
    /// Whether its slope is stated and not learnt.
    still: bool,
    /// What has been added to it since it was trained: amplitudes of [`basis`]; empty for nothing.
    added: Vec<f64>,
}

impl StaticMap {
    /// The static map of `model`, its readings in the yardstick's units; its effects are not part of it.
    pub fn new(model: &Model, yardstick: &Yardstick) -> Self {
        let (network, scale) = (Network::new(&model.weights()), Scale::new(&model.scaling.to_wire()));
        Self {
            weights: model.weights(),
            network,
            scale,
            model: model.clone(),
            factor: yardstick.factor(),
            still: false,
            added: Vec::new(),
        }
    }

    /// The same map, its slope stated and not learnt if the sensor is still.
    pub fn of_still(self, still: bool) -> Self {
        Self { still, ..self }
    }

    /// What the static map reads at the scaled inputs, g.
    pub fn reading_g(&self, x: f64, t: f64) -> f64 {
        let reading_g = self.factor * self.scale.reading_g(x, t, self.network.evaluate(x, t));
        if self.added.is_empty() {
            return reading_g;
        }
        let added: f64 = self.functions(x, t).iter().zip(&self.added).map(|(value, amplitude)| value * amplitude).sum();
        reading_g + added * self.output_ug() / UG
    }

    /// What retraining could add at scaled inputs, in units of the network's output, each at its expected size.
    pub fn functions(&self, x: f64, t: f64) -> Vec<f64> {
        if self.still { basis::of_course(t) } else { basis::of_retraining(&self.weights, x, t) }
    }

    /// The same map as it was trained.
    pub fn as_trained(&self) -> Self {
        Self { added: Vec::new(), ..self.clone() }
    }

    /// The same map with so much more of each function.
    pub fn with(&self, amplitudes: impl Iterator<Item = f64>) -> Self {
        let mut map = self.clone();
        let before = self.added.iter().copied().chain(std::iter::repeat(0.0));
        map.added = amplitudes.zip(before).map(|(more, before)| before + more).collect();
        map
    }

    /// Reading minus reference in each cell, µg, under these contributions: of each run cells × 1.
    pub fn residual_ug(&self, cells: &Cells, contributions: &Contributions) -> Columns {
        let of = |(run, contributions): (&RunCells, &Vec<Contribution>)| {
            let values = run
                .cells
                .iter()
                .zip(contributions)
                .map(|(cell, contribution)| self.cell_residual_ug(cells, cell, contribution));
            DMatrix::from_iterator(run.cells.len(), 1, values)
        };
        cells.runs.par_iter().zip(contributions).map(of).collect()
    }

    /// The same under `own` contributions too, beside fixed ones that leave `before`, µg: of each run cells × 1.
    pub fn residual_beside_ug(
        &self,
        cells: &Cells,
        fixed: &Contributions,
        before: &Columns,
        own: &Contributions,
    ) -> Columns {
        let of = |(index, run): (usize, &RunCells)| {
            let value = |(row, cell): (usize, &Cell)| {
                let contribution = &own[index][row];
                // What only adds to the output asks nothing of the network.
                if contribution.moves_nothing() {
                    return before[index][(row, 0)] - contribution.bias_g * UG;
                }
                self.cell_residual_ug(cells, cell, &fixed[index][row].plus(contribution))
            };
            DMatrix::from_iterator(run.cells.len(), 1, run.cells.iter().enumerate().map(value))
        };
        cells.runs.par_iter().enumerate().map(of).collect()
    }

    fn cell_residual_ug(&self, cells: &Cells, cell: &Cell, contribution: &Contribution) -> f64 {
        let [x, t] = moved(cells, cell, contribution);
        (self.reading_g(x, t) - contribution.bias_g - cell.level_g) * UG
    }

    /// RMS slope over temperature at a given frequency difference, µg/°C.
    pub fn ug_per_c(&self, cells: &Cells) -> f64 {
        let reading = |x: f64, t: f64| self.reading_g(x, t) * UG;
        let slope = |cell: &Cell| (reading(cell.x, cell.t + 0.01) - reading(cell.x, cell.t - 0.01)) / 0.02;
        let slopes: Vec<f64> = cells.iter().map(slope).collect();
        rms(&slopes) / cells.scale.temperature_half_span_c
    }

    /// How far it goes to either side at medium temperature, g.
    pub fn reach_g(&self) -> f64 {
        (self.reading_g(1.0, 0.0) - self.reading_g(-1.0, 0.0)).abs() / 2.0
    }

    /// At the middle of the domain, Hz/g.
    pub fn scale_factor_hz_per_g(&self, cells: &Cells) -> f64 {
        cells.scale.delta_f_half_span_hz * 2.0 / (self.reading_g(1.0, 0.0) - self.reading_g(-1.0, 0.0))
    }

    /// A unit of the network's output, µg.
    pub fn output_ug(&self) -> f64 {
        (self.factor * f64::from(self.model.scaling.output_g)).abs() * UG
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{G_PER_C, Recipe, problem};

    #[test]
    fn a_line_reads_what_it_says() {
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let (map, cells) = (&problem.forward.map, problem.cells());
        assert!((map.reading_g(0.5, -1.0) - (0.625 - 1.0 / 32.0)).abs() < 1e-12);
        assert!((map.reach_g() - 1.25).abs() < 1e-12);
        assert!((map.scale_factor_hz_per_g(cells) - 409.6).abs() < 1e-9);
        assert!((map.ug_per_c(cells) - G_PER_C * 1e6).abs() < 1e-6);
        assert!((map.output_ug() - 3000.0).abs() < 1e-3);
    }

    #[test]
    fn what_an_effect_does_is_taken_out_at_the_inputs_and_at_the_output() {
        let campaign = Recipe { runs: 2, rows: 60, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let (map, cells) = (&problem.forward.map, problem.cells());
        let everywhere =
            |one: Contribution| -> Contributions { cells.runs.iter().map(|run| vec![one; run.cells.len()]).collect() };
        let none = everywhere(Contribution::default());
        let alone = map.residual_ug(cells, &none);
        let bias = Contribution { bias_g: 3e-6, ..Contribution::default() };
        let warm = Contribution { temperature_c: 0.5, ..Contribution::default() };
        let faster = Contribution { delta_f_hz: 0.004, ..Contribution::default() };
        // µg: warmer resonators enter the map elsewhere; a frequency that an effect added is not the signal's.
        for (contribution, worked_ug) in [
            (bias, -3.0),
            (warm, 0.5 * G_PER_C * 1e6),
            (faster, -0.004 / 409.6 * 1e6),
            (bias.plus(&warm), 0.5 * G_PER_C * 1e6 - 3.0),
        ] {
            let (whole, beside) = (
                map.residual_ug(cells, &everywhere(contribution)),
                map.residual_beside_ug(cells, &none, &alone, &everywhere(contribution)),
            );
            for run in 0..2 {
                assert!((&whole[run] - &alone[run]).add_scalar(-worked_ug).amax() < 1e-6, "{contribution:?}");
                assert!((&whole[run] - &beside[run]).amax() < 1e-6, "{contribution:?}");
            }
        }
    }
}
