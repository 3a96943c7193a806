//! Rows moved by physical effects, for fitting their coefficients together with the network.
//!
//! The effects are the device's own ([`firmware_core::Terms`]) in `f64`, run over every raw sample so that
//! their memories see the true history; what they do is averaged over the cells that the optimiser
//! works on. Their level is the reference: during calibration it is known.

use super::dataset::{InputScale, mean};
use super::neighbours::Neighbours;
use super::network::{Group, Rows, Tangent, ValueRow};
use super::polynomial::Polynomial;
use crate::campaign::{Row, Run};
use crate::expression::Expression;
use crate::noise::Components;
use firmware_core::effect::{About, Parameter, Role};
use firmware_core::{Observation, Terms};
use protocol::Scaling;
use std::ops::Range;

/// An effect chosen for a model: which one, and which of the campaign's channels it follows.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The effect.
    pub about: &'static About,
    /// Index of its auxiliary channel.
    pub channel: usize,
    /// Mean of that channel over the training runs: where [`Role::Origin`] counts from.
    pub origin: f64,
    /// What an effect of the user's own depends on.
    pub expression: Option<Expression>,
    /// What amplitude 1 does over the training runs, RMS, g: an expression may have any unit, and the
    /// optimiser should not notice. 1 where the unit is the effect's own.
    pub size: f64,
}

impl Chosen {
    /// An effect that follows no channel.
    #[must_use]
    pub const fn of(about: &'static About) -> Self {
        Self { about, channel: 0, origin: 0.0, expression: None, size: 1.0 }
    }

    /// Whether it follows this channel of the campaign.
    #[must_use]
    pub fn follows(&self, channel: usize) -> bool {
        match &self.expression {
            Some(expression) => expression.follows(channel),
            None => self.about.channel.is_some() && self.channel == channel,
        }
    }

    /// The value of a coefficient that is not fitted: a fit can't tell an origin from the bias, and a time
    /// constant means nothing to an expression that doesn't look back.
    fn fixed(&self, parameter: &Parameter) -> Option<f64> {
        let idle = self.expression.as_ref().is_some_and(|expression| expression.leaves_idle(parameter));
        match parameter.role {
            Role::Origin => Some(self.origin),
            _ => idle.then_some(parameter.start),
        }
    }

    /// The parameters that a fit chooses.
    pub(crate) fn free(&self) -> impl Iterator<Item = &'static Parameter> {
        self.about.parameters.iter().filter(|about| self.is_free(about))
    }

    fn is_free(&self, parameter: &Parameter) -> bool {
        self.fixed(parameter).is_none()
    }

    /// The optimiser's parameter for a coefficient's value, and back.
    fn parameter_of(&self, parameter: &Parameter, value: f64) -> f64 {
        match parameter.role {
            Role::Amplitude => value * self.size,
            Role::Shape => value.ln(),
            Role::Location | Role::Origin => value,
        }
    }

    fn value_of(&self, parameter: &Parameter, free: f64) -> f64 {
        let value = match parameter.role {
            Role::Amplitude => free / self.size,
            Role::Shape => free.exp(),
            Role::Location | Role::Origin => free,
        };
        value.clamp(parameter.low, parameter.high)
    }

    /// What amplitude 1 adds to the bias at every sample of a run, g.
    #[must_use]
    pub fn course_g(&self, run: &Run, max_gap_us: u32) -> Vec<f64> {
        let value = |parameter: &Parameter| if parameter.role == Role::Amplitude { 1.0 } else { parameter.start };
        let values = vec![self.about.parameters.iter().map(value).collect()];
        let contributions = contributions(&run.rows, std::slice::from_ref(self), &Coefficients { values }, max_gap_us);
        contributions.unwrap_or_default().iter().map(|contribution| contribution.bias_g).collect()
    }
}

/// Coefficients of several effects, and the optimiser's view of them.
#[derive(Clone, Debug)]
pub struct Coefficients {
    /// Effect by effect, in its own order and units.
    pub values: Vec<Vec<f64>>,
}

impl Coefficients {
    /// The optimiser's parameters: amplitudes in g, shapes as logarithms, what is not fitted left out.
    #[must_use]
    pub fn to_parameters(&self, effects: &[Chosen]) -> Vec<f64> {
        let mut parameters = Vec::new();
        for (effect, values) in effects.iter().zip(&self.values) {
            let free = effect.about.parameters.iter().zip(values).filter(|(about, _)| effect.is_free(about));
            parameters.extend(free.map(|(about, value)| effect.parameter_of(about, *value)));
        }
        parameters
    }

    /// The inverse, held within what makes physical sense.
    #[must_use]
    pub fn from_parameters(effects: &[Chosen], parameters: &[f64]) -> Self {
        let mut next = parameters.iter().copied();
        let mut value = |effect: &Chosen, about: &Parameter| match effect.fixed(about) {
            Some(fixed) => fixed,
            None => effect.value_of(about, next.next().unwrap_or_default()),
        };
        let of = |effect: &Chosen| effect.about.parameters.iter().map(|about| value(effect, about)).collect();
        Self { values: effects.iter().map(of).collect() }
    }
}

/// What the effects do at one sample.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Contribution {
    /// Resonators minus thermometer, °C.
    pub temperature_c: f64,
    /// Frequency difference with the effects minus without, Hz.
    pub delta_f_hz: f64,
    /// Added to the output, g.
    pub bias_g: f64,
}

impl Contribution {
    /// Both.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            temperature_c: self.temperature_c + other.temperature_c,
            delta_f_hz: self.delta_f_hz + other.delta_f_hz,
            bias_g: self.bias_g + other.bias_g,
        }
    }

    /// Whether the inputs stay as they are.
    pub(crate) fn moves_nothing(&self) -> bool {
        self.temperature_c == 0.0 && self.delta_f_hz == 0.0
    }

    /// So much of it.
    pub(crate) fn times(&self, share: f64) -> Self {
        Self {
            temperature_c: self.temperature_c * share,
            delta_f_hz: self.delta_f_hz * share,
            bias_g: self.bias_g * share,
        }
    }
}

/// Runs the effects over a run, row by row; `None` if the core refuses the coefficients.
pub(crate) fn contributions(
    rows: &[Row],
    effects: &[Chosen],
    coefficients: &Coefficients,
    max_gap_us: u32,
) -> Option<Vec<Contribution>> {
    let mut terms = Terms::<f64>::new(max_gap_us);
    for (effect, values) in effects.iter().zip(&coefficients.values) {
        let program = effect.expression.as_ref().map_or(&[][..], |expression| expression.code());
        terms.push(effect.about.id, effect.channel, usize::MAX, values.iter().copied(), program).ok()?;
    }
    let contribution = |row: &Row| {
        let now = Observation::<f64>::new(&row.sample, &FROM_ZERO);
        terms.advance(&row.sample, row.reference_g);
        let disturbance = terms.disturbance(&now, row.reference_g);
        Contribution {
            temperature_c: disturbance.temperature_c,
            delta_f_hz: disturbance.delta_f_hz,
            bias_g: terms.bias_g(&now, row.reference_g),
        }
    };
    Some(rows.iter().map(contribution).collect())
}

/// Effects look at absolute quantities only, so the zeros don't matter here.
const FROM_ZERO: Scaling = Scaling {
    delta_f_zero_uhz: 0,
    delta_f_gain_per_hz: 1.0,
    temperature_zero_uc: 0,
    temperature_gain_per_c: 1.0,
    line_g: [0.0; 4],
    output_g: 0.0,
};

/// One cell without effects, in scaled inputs and g.
#[derive(Clone, Debug)]
struct Still {
    rows: Range<usize>,
    x: f64,
    t: f64,
    reference_g: f64,
}

/// The rows of the training runs, moved by effects.
pub struct MovedRows<'a> {
    runs: Vec<(&'a Run, Vec<Still>)>,
    effects: &'a [Chosen],
    scale: InputScale,
    line: Polynomial,
    unit_g: f64,
    max_gap_us: u32,
    groups: Vec<Group>,
    tangents: Vec<Tangent>,
}

/// What the rows are measured in.
pub struct Frame {
    /// Scale of the inputs.
    pub scale: InputScale,
    /// The line that the network departs from.
    pub line: Polynomial,
    /// g per unit of network output.
    pub unit_g: f64,
    /// Longest gap across which a memory is carried, µs.
    pub max_gap_us: u32,
}

/// Step of the finite differences, relative for shapes (they are logarithms).
const STEP: f64 = 1e-5;

impl<'a> MovedRows<'a> {
    /// The rows of `runs` under `effects`, each weighted by what `noise` says it is worth.
    #[must_use]
    pub fn new(runs: &[&'a Run], effects: &'a [Chosen], frame: Frame, noise: &Components) -> Self {
        let Frame { scale, line, unit_g, max_gap_us } = frame;
        let neighbours = Neighbours::of(runs.iter().copied(), &scale);
        let still = |run: &'a Run| (run, still_cells(run, &scale, &neighbours));
        let runs: Vec<_> = runs.iter().copied().map(still).collect();
        let group = |(run, (_, cells)): (usize, &(&Run, Vec<Still>))| Group {
            rows: cells.iter().map(|cell| weigh(run, cell, noise)).collect(),
            offset_variance: noise.run_variance(),
        };
        let groups = runs.iter().enumerate().map(group).collect();
        Self { runs, effects, scale, line, unit_g, max_gap_us, groups, tangents: Vec::new() }
    }

    /// The rows before any effect.
    #[must_use]
    pub fn still(mut self) -> Vec<Group> {
        self.effects = &[];
        self.update(&[], false);
        self.groups
    }

    /// Moves the rows to where these coefficients put them.
    fn place(&self, parameters: &[f64], mut put: impl FnMut(usize, usize, [f64; 3])) {
        let coefficients = Coefficients::from_parameters(self.effects, parameters);
        for (group, (run, cells)) in self.runs.iter().enumerate() {
            let Some(contributions) = contributions(&run.rows, self.effects, &coefficients, self.max_gap_us) else {
                continue;
            };
            for (index, cell) in cells.iter().enumerate() {
                put(group, index, self.placed(cell, &mean_contribution(&contributions[cell.rows.clone()])));
            }
        }
    }

    /// Inputs and target of a cell on which the effects act: the compensator's formula, read backwards.
    fn placed(&self, cell: &Still, contribution: &Contribution) -> [f64; 3] {
        let x = cell.x - contribution.delta_f_hz / self.scale.delta_f_half_span_hz;
        let t = cell.t + contribution.temperature_c / self.scale.temperature_half_span_c;
        [x, t, (cell.reference_g + contribution.bias_g - self.line.evaluate(x, t)) / self.unit_g]
    }
}

fn still_cells(run: &Run, scale: &InputScale, neighbours: &Neighbours) -> Vec<Still> {
    let still = |rows: Range<usize>| {
        let datum = mean(&run.rows[rows.clone()], 0, scale);
        Still { rows, x: datum.x, t: datum.t, reference_g: datum.reference_g }
    };
    neighbours.cells(run).into_iter().map(still).collect()
}

fn weigh(run: usize, cell: &Still, noise: &Components) -> ValueRow {
    let samples = cell.rows.len() as f64;
    ValueRow { x: cell.x, t: cell.t, y: 0.0, weight: noise.weight(run, samples), samples }
}

pub(crate) fn mean_contribution(contributions: &[Contribution]) -> Contribution {
    let share = 1.0 / contributions.len() as f64;
    contributions.iter().fold(Contribution::default(), |sum, contribution| sum.plus(&contribution.times(share)))
}

impl Rows for MovedRows<'_> {
    fn parameters(&self) -> usize {
        self.effects.iter().map(|effect| effect.free().count()).sum()
    }

    fn update(&mut self, parameters: &[f64], tangents: bool) {
        let mut groups = std::mem::take(&mut self.groups);
        self.place(parameters, |group, index, [x, t, y]| {
            let row = &mut groups[group].rows[index];
            (row.x, row.t, row.y) = (x, t, y);
        });
        self.groups = groups;
        if tangents {
            self.tangents = self.differences(parameters);
        }
    }

    fn groups(&self) -> &[Group] {
        &self.groups
    }

    fn tangents(&self) -> &[Tangent] {
        &self.tangents
    }
}

impl MovedRows<'_> {
    /// Tangents by forward differences from the rows' present place.
    fn differences(&self, parameters: &[f64]) -> Vec<Tangent> {
        let count: usize = self.groups.iter().map(|group| group.rows.len()).sum();
        let mut tangents = vec![Tangent::default(); count * parameters.len()];
        for j in 0..parameters.len() {
            let mut stepped = parameters.to_vec();
            stepped[j] += STEP;
            let step = stepped[j] - parameters[j];
            let mut next = 0;
            self.place(&stepped, |group, index, [x, t, y]| {
                let row = &self.groups[group].rows[index];
                tangents[next * parameters.len() + j] =
                    Tangent { x: (x - row.x) / step, t: (t - row.t) / step, y: (y - row.y) / step };
                next += 1;
            });
        }
        tangents
    }
}
