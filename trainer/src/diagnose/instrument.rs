//! The instrument as it is modelled now, in cells: what it reads wrong, and what retraining could make of that.

use super::candidate::is_placed;
use super::layout::{Cell, Layout, Stretch};
use super::sum_channel::is_told;
use super::whitening::Columns;
use crate::campaign::Row;
use crate::expression::Expression;
use crate::fit::effects::{Chosen, Coefficients, Contribution, contributions, mean_contribution};
use crate::fit::network::{HIDDEN_SIZE, OUTPUT_SIZE};
use crate::model::Model;
use crate::noise::{rms, sample_sigma_g};
use crate::yardstick::Yardstick;
use firmware_core::activation::{sigmoid, slope};
use firmware_core::effect::{self, About, Role};
use firmware_core::{Memory, Network, Scale};
use nalgebra::DMatrix;
use protocol::limits::{HIDDEN, MAX_PARAMETERS};
use rayon::prelude::*;

/// g to µg.
const UG: f64 = 1e6;
/// Noise is never taken to be less, µg.
const LEAST_UG: f64 = 1e-3;

/// The static map and the effects that are known so far.
#[derive(Clone)]
pub(super) struct Instrument {
    model: Model,
    network: Network<f64>,
    scale: Scale<f64>,
    /// What its readings are multiplied with.
    factor: f64,
}

/// Effects with their coefficients.
#[derive(Clone, Debug)]
pub(super) struct Known {
    /// The effects.
    pub effects: Vec<Chosen>,
    /// Their coefficients.
    pub coefficients: Coefficients,
}

impl Known {
    /// No effects.
    pub const NONE: Self = Self { effects: Vec::new(), coefficients: Coefficients { values: Vec::new() } };

    /// These and one more.
    pub fn with(&self, effect: &Chosen, values: &[f64]) -> Self {
        let mut known = self.clone();
        known.effects.push(effect.clone());
        known.coefficients.values.push(values.to_vec());
        known
    }

    /// These and others.
    pub fn and(&self, others: &Self) -> Self {
        let mut known = self.clone();
        known.effects.extend(others.effects.iter().cloned());
        known.coefficients.values.extend(others.coefficients.values.iter().cloned());
        known
    }

    /// The same effects with other parameters, held within their bounds.
    pub fn at(&self, parameters: &[f64]) -> Self {
        let coefficients = Coefficients::from_parameters(&self.effects, parameters);
        Self { effects: self.effects.clone(), coefficients }
    }

    /// Each by itself.
    pub fn each(&self) -> impl Iterator<Item = Self> {
        self.effects.iter().zip(&self.coefficients.values).map(|(effect, values)| Self::NONE.with(effect, values))
    }

    /// How far each free parameter may be from where it is, in the optimiser's units: an amplitude by all of it, a shape by
    /// a factor of e, a place by the effect's own width.
    pub fn reaches(&self) -> Vec<f64> {
        let parameters = self.coefficients.to_parameters(&self.effects);
        let free = self.effects.iter().zip(&self.coefficients.values).flat_map(|(effect, values)| {
            let width = effect.about.parameters.iter().zip(values).find(|(about, _)| about.role == Role::Shape);
            let width = width.map_or(1.0, |(_, width)| *width);
            effect.free().map(move |about| (about.role, width))
        });
        free.zip(parameters)
            .map(|((role, width), parameter)| match role {
                Role::Amplitude => parameter.abs(),
                Role::Shape => 1.0,
                Role::Location | Role::Origin => width,
            })
            .collect()
    }

    /// What each of them remembers.
    pub fn memories(&self) -> impl Iterator<Item = Memory<f64>> {
        self.effects.iter().zip(&self.coefficients.values).map(|(chosen, values)| {
            let mut coefficients = [0.0; MAX_PARAMETERS];
            coefficients.iter_mut().zip(values).for_each(|(slot, value)| *slot = *value);
            let leaves_idle = |text: &Expression| chosen.about.parameters.iter().any(|about| text.leaves_idle(about));
            let idle = chosen.expression.as_ref().is_some_and(leaves_idle);
            let effect = effect::find::<f64>(chosen.about.id).filter(|_| !idle);
            effect.map_or(Memory::None, |effect| effect.memory(&coefficients))
        })
    }

    /// Those of which this is true, and the others.
    fn split(&self, is: impl Fn(&About) -> bool) -> (Self, Self) {
        let mut both = (Self::NONE, Self::NONE);
        for (effect, values) in self.effects.iter().zip(&self.coefficients.values) {
            let side = if is(effect.about) { &mut both.0 } else { &mut both.1 };
            side.effects.push(effect.clone());
            side.coefficients.values.push(values.clone());
        }
        both
    }

    /// Of each free parameter, whether the sum of the frequencies tells of it.
    pub fn tells(&self) -> impl Iterator<Item = bool> {
        self.effects.iter().flat_map(|effect| effect.free().map(|_| is_told(effect.about)))
    }

    /// Those whose contributions say what happens to the sum of the frequencies.
    pub fn told(&self) -> Self {
        self.split(is_told).0
    }

    /// Those that leave open what happens to it.
    pub fn untold(&self) -> Self {
        self.split(is_told).1
    }

    /// These but the one at `index`.
    pub fn without(&self, index: usize) -> Self {
        let mut known = self.clone();
        known.effects.remove(index);
        known.coefficients.values.remove(index);
        known
    }
}

/// Mean contributions of the cells, run by run.
pub(super) type Contributions = Vec<Vec<Contribution>>;

/// Highest powers of frequency difference and temperature, and of both together, by which a retrained map may differ.
const POWERS: (usize, usize, usize) = (3, 6, 7);
/// How far it may differ from such a polynomial, as a share of the network's own size.
const FREEDOM: f64 = 0.1;

impl Instrument {
    /// The static map of `model`, its readings in the yardstick's units; its effects are not part of it.
    pub fn new(model: &Model, yardstick: &Yardstick) -> Self {
        let (network, scale) = (Network::new(&model.weights()), Scale::new(&model.scaling.to_wire()));
        Self { network, scale, model: model.clone(), factor: yardstick.factor() }
    }

    /// What the static map reads at the scaled inputs, g.
    pub fn reading_g(&self, x: f64, t: f64) -> f64 {
        self.factor * self.scale.reading_g(x, t, self.network.evaluate(x, t))
    }

    /// What the effects do in each cell.
    pub fn contributions(&self, layout: &Layout, known: &Known) -> Contributions {
        let (placed, others) = known.split(is_placed);
        let of = |stretch: &Stretch| {
            let course = |rows: &[Row], known: &Known| {
                let some = !known.effects.is_empty();
                some.then(|| contributions(rows, &known.effects, &known.coefficients, layout.max_gap_us)).flatten()
            };
            let mut all = match course(&stretch.run.rows, &others) {
                Some(course) => {
                    stretch.cells.iter().map(|cell| mean_contribution(&course[cell.rows.clone()])).collect()
                }
                None => vec![Contribution::default(); stretch.cells.len()],
            };
            if let Some(course) = course(&stretch.gathered.rows, &placed) {
                for (&(cell, share), contribution) in stretch.gathered.places.iter().zip(course) {
                    all[cell] = all[cell].plus(&contribution.times(share));
                }
            }
            all
        };
        layout.stretches.par_iter().map(of).collect()
    }

    /// Reading minus reference in each cell, µg, under these contributions.
    pub fn residual_ug(&self, layout: &Layout, contributions: &Contributions) -> Columns {
        let of = |(stretch, contributions): (&Stretch, &Vec<Contribution>)| {
            let values = stretch
                .cells
                .iter()
                .zip(contributions)
                .map(|(cell, contribution)| self.cell_residual_ug(layout, cell, contribution));
            DMatrix::from_iterator(stretch.cells.len(), 1, values)
        };
        layout.stretches.par_iter().zip(contributions).map(of).collect()
    }

    /// The same under `own` contributions too, beside `held` ones that leave `before`.
    pub fn residual_beside_ug(
        &self,
        layout: &Layout,
        held: &Contributions,
        before: &Columns,
        own: &Contributions,
    ) -> Columns {
        let of = |(run, stretch): (usize, &Stretch)| {
            let value = |(index, cell): (usize, &Cell)| {
                let contribution = &own[run][index];
                // What only adds to the output asks nothing of the network.
                if contribution.moves_nothing() {
                    return before[run][(index, 0)] - contribution.bias_g * UG;
                }
                self.cell_residual_ug(layout, cell, &held[run][index].plus(contribution))
            };
            DMatrix::from_iterator(stretch.cells.len(), 1, stretch.cells.iter().enumerate().map(value))
        };
        layout.stretches.par_iter().enumerate().map(of).collect()
    }

    fn cell_residual_ug(&self, layout: &Layout, cell: &Cell, contribution: &Contribution) -> f64 {
        let x = cell.x - contribution.delta_f_hz / layout.scale.delta_f_half_span_hz;
        let t = cell.t + contribution.temperature_c / layout.scale.temperature_half_span_c;
        (self.reading_g(x, t) - contribution.bias_g - cell.level_g) * UG
    }

    /// How the reading can change by retraining, µg per expected change: polynomials and the network's tangents.
    pub fn freedom(&self, layout: &Layout) -> Columns {
        let still = layout.is_still();
        let row = |cell: &Cell| {
            if still {
                // The slope is stated, not learnt: retraining can change the course over temperature only.
                return chebyshev(POWERS.1, cell.t);
            }
            let mut values = polynomials(cell.x, cell.t);
            values.extend(self.tangents(cell).map(|value| value * FREEDOM));
            values
        };
        self.departures(layout, row)
    }

    /// How the reading of a smooth instrument can change, µg per expected change: polynomials alone.
    pub fn smooth(&self, layout: &Layout) -> Columns {
        self.departures(layout, |cell| polynomials(cell.x, cell.t))
    }

    /// A row of departures from the line in each cell, µg, from those in units of the network's output.
    fn departures(&self, layout: &Layout, row: impl Fn(&Cell) -> Vec<f64> + Sync) -> Columns {
        let departure_ug = (self.factor * f64::from(self.model.scaling.output_g)).abs() * UG;
        let of = |stretch: &Stretch| {
            let rows: Vec<Vec<f64>> = stretch.cells.iter().map(&row).collect();
            let width = rows.first().map_or(0, Vec::len);
            DMatrix::from_row_iterator(rows.len(), width, rows.into_iter().flatten().map(|value| value * departure_ug))
        };
        layout.stretches.par_iter().map(of).collect()
    }

    /// Scatter of the static reading from sample to sample, µg.
    pub fn sample_ug(&self, layout: &Layout) -> Option<f64> {
        let residuals = |stretch: &Stretch| -> Vec<f64> {
            let of = |row: &Row| {
                let [x, t] = layout.scale.inputs(&row.sample);
                (self.reading_g(x, t) - row.reference_g) * UG
            };
            stretch.run.rows.iter().map(of).collect()
        };
        let all: Vec<Vec<f64>> = layout.stretches.iter().map(residuals).collect();
        sample_sigma_g(layout.stretches.iter().map(|stretch| stretch.run).zip(&all)).map(|sigma| sigma.max(LEAST_UG))
    }

    /// RMS slope over temperature at a given frequency difference, µg/°C.
    pub fn ug_per_c(&self, layout: &Layout) -> f64 {
        let reading = |x: f64, t: f64| self.reading_g(x, t) * UG;
        let slope = |cell: &Cell| (reading(cell.x, cell.t + 0.01) - reading(cell.x, cell.t - 0.01)) / 0.02;
        let slopes: Vec<f64> = layout.cells().map(slope).collect();
        rms(&slopes) / layout.scale.temperature_half_span_c
    }

    /// How far it goes to either side at medium temperature, g.
    pub fn reach_g(&self) -> f64 {
        (self.reading_g(1.0, 0.0) - self.reading_g(-1.0, 0.0)).abs() / 2.0
    }

    /// At the middle of the domain, Hz/g.
    pub fn scale_factor_hz_per_g(&self, layout: &Layout) -> f64 {
        layout.scale.delta_f_half_span_hz * 2.0 / (self.reading_g(1.0, 0.0) - self.reading_g(-1.0, 0.0))
    }

    fn tangents(&self, cell: &Cell) -> impl Iterator<Item = f64> {
        let weights = self.model.weights();
        let (x, t) = (cell.x, cell.t);
        (0..HIDDEN).flat_map(move |unit| {
            let [wx, wt] = weights.input[unit].map(f64::from);
            let u = f64::from(weights.bias[unit]) + wx * x + wt * t;
            let rise = slope(u) * f64::from(weights.output[unit]) * HIDDEN_SIZE;
            [sigmoid(u) * OUTPUT_SIZE, rise * x, rise * t, rise]
        })
    }
}

/// Chebyshev polynomials of both inputs.
pub(super) fn polynomials(x: f64, t: f64) -> Vec<f64> {
    let (most_x, most_t, most) = POWERS;
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
