//! One campaign and one model before the judge: what is measured, and what a set of effects leaves of it.

use super::evidence::{Bench, difference, joined, stacked, width};
use super::instrument::{Deeds, Instrument, Known};
use super::layout::{Cell, Layout, Stretch};
use super::noise_search::{first_guess, noise};
use super::sum_channel::{Response, SumChannel, response};
use super::whitening::{Columns, NoiseModel, TURN, WANDER};
use nalgebra::{DMatrix, DVector};

/// The measurements, the instrument, and what it is free to become.
#[derive(Clone)]
pub(super) struct Case<'a> {
    /// The cells.
    pub layout: Layout<'a>,
    /// The static map.
    pub instrument: Instrument,
    /// What retraining can absorb.
    pub freedom: Columns,
    /// The sum of the frequencies, if it was measured.
    pub sum: Option<SumChannel>,
    /// Noise of a sample, µg.
    pub sample_ug: f64,
    /// The reading's slope over temperature, µg/°C.
    pub ug_per_c: f64,
}

/// Noise of difference and sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noises {
    /// Of the residual, µg.
    pub delta: NoiseModel,
    /// Of the sum of the frequencies, mHz.
    pub sum: Option<NoiseModel>,
}

impl Noises {
    /// No part larger than the sample noise: what an effect hides behind is not taken for noise.
    pub fn small(&self) -> Self {
        Self { delta: self.delta.small(), sum: self.sum.map(|noise| noise.small()) }
    }
}

/// What effects leave.
#[derive(Clone)]
pub(super) struct Left {
    /// Residual, µg.
    pub delta: Columns,
    /// Residual of the sum, mHz.
    pub sum: Option<Columns>,
}

/// What may still adapt.
#[derive(Clone)]
pub(super) struct Freedom {
    /// What retraining can absorb of the residual.
    pub delta: Columns,
    /// What a change of the sum's map, and effects that don't say what they do to the sum, can absorb of it.
    pub sum: Option<Columns>,
}

/// Effects whose deeds don't change while others are fitted.
pub(super) struct Held {
    all: Deeds,
    told: Deeds,
}

/// Both benches under one noise.
pub(super) struct Benches<'a> {
    /// For the residual.
    pub delta: Bench<'a>,
    /// For the sum.
    pub sum: Option<Bench<'a>>,
}

/// Step of numeric derivatives: of logarithms and °C as it is, of amplitudes times their size.
const STEP: f64 = 1e-4;
/// A refit ends when a step gains less than this.
const REFIT_GAIN: f64 = 0.02;
const MOST_DAMPING: f64 = 1e6;
/// Slope of the sum of two forks of silicon near 40 kHz over temperature, where it was not measured.
const SILICON_HZ_PER_C: f64 = 4.8;

impl Case<'_> {
    /// The same measurements, of which is known how much of what these effects brought along is still there.
    pub fn remembering(&self, known: &Known) -> Self {
        let mut case = self.clone();
        case.layout.remember(known);
        case
    }

    /// By how many °C temperature must change to move a fork as 1 g does: both change its frequency by half of what they
    /// change difference and sum.
    pub fn shift_c_per_g(&self) -> f64 {
        let hz_per_c = self.sum.as_ref().map_or(SILICON_HZ_PER_C, |sum| sum.per_c.abs() * 1e-3);
        self.instrument.scale_factor_hz_per_g(&self.layout).abs() / hz_per_c.max(f64::MIN_POSITIVE)
    }

    /// Columns with a value in each cell.
    pub fn columns<const N: usize>(&self, of: impl Fn(usize, &Stretch, &Cell) -> [f64; N]) -> Columns {
        let run = |(index, stretch): (usize, &Stretch)| {
            let rows = stretch.cells.iter().flat_map(|cell| of(index, stretch, cell));
            DMatrix::from_row_iterator(stretch.cells.len(), N, rows)
        };
        self.layout.stretches.iter().enumerate().map(run).collect()
    }

    /// RMS over the samples, µg.
    pub fn rms_ug(&self, course: &Columns) -> f64 {
        let pairs = self.layout.cells().zip(course.iter().flat_map(|run| run.iter()));
        let (squares, samples) = pairs
            .fold((0.0, 0.0), |(sum, all), (cell, value)| (sum + cell.samples * value * value, all + cell.samples));
        (squares / f64::max(samples, 1.0)).sqrt()
    }

    /// These effects, to be held.
    pub fn held(&self, known: &Known) -> Held {
        Held {
            all: self.instrument.deeds(&self.layout, known),
            told: self.instrument.deeds(&self.layout, &known.told()),
        }
    }

    /// What these effects leave.
    pub fn left(&self, known: &Known) -> Left {
        self.left_beside(None, known)
    }

    /// What these effects leave together with those that are held.
    pub fn left_beside(&self, held: Option<&Held>, known: &Known) -> Left {
        let with = |own: &Known, held: Option<&Deeds>, residual: &dyn Fn(&[&Deeds]) -> Columns| {
            let own = self.instrument.deeds(&self.layout, own);
            held.map_or_else(|| residual(&[&own]), |held| residual(&[held, &own]))
        };
        let delta = with(known, held.map(|held| &held.all), &|deeds| self.instrument.residual_ug(&self.layout, deeds));
        let sum = self.sum.as_ref().map(|channel| {
            with(&known.told(), held.map(|held| &held.told), &|deeds| channel.residual_under(&self.layout, deeds))
        });
        Left { delta, sum }
    }

    /// What may adapt around these effects, their own parameters held.
    pub fn stiff(&self, known: &Known) -> Freedom {
        let sum = self.sum.as_ref().map(|channel| {
            let free = known.each().filter(|one| response(one.effects[0].about) != Response::Told);
            let columns: Vec<Columns> = free.map(|one| self.alone(&one)).collect();
            if columns.is_empty() { channel.freedom.clone() } else { stacked(&channel.freedom, &joined(&columns)) }
        });
        Freedom { delta: self.freedom.clone(), sum }
    }

    /// What may adapt, the effects' own parameters too.
    pub fn adapting(&self, known: &Known) -> Freedom {
        let freedom = self.stiff(known);
        if known.effects.is_empty() { freedom } else { self.widened(&freedom, &self.held(&Known::NONE), known) }
    }

    /// `freedom`, and the parameters of effects beside others that are held.
    pub fn widened(&self, freedom: &Freedom, held: &Held, own: &Known) -> Freedom {
        let (delta, sum) = self.tangents(Some(held), own);
        let both = freedom.sum.as_ref().zip(sum.as_ref()).zip(self.sum.as_ref());
        Freedom {
            delta: stacked(&freedom.delta, &generous(&delta, self.sample_ug)),
            sum: both.map(|((freedom, sum), channel)| stacked(freedom, &generous(sum, channel.sample))),
        }
    }

    /// The column of effects by themselves, µg, scaled up to be free.
    fn alone(&self, known: &Known) -> Columns {
        let (after, before) = (self.left(known).delta, self.left(&Known::NONE).delta);
        difference(&after, &before).into_iter().map(|run| run * FREE).collect()
    }

    /// The benches for what is left, under `noises`.
    pub fn benches(&self, left: &Left, freedom: &Freedom, noises: &Noises) -> Option<Benches<'_>> {
        let delta = Bench::new(&self.layout, noises.delta, &left.delta, &freedom.delta)?;
        let sum = match (&left.sum, &freedom.sum, noises.sum) {
            (Some(sum), Some(freedom), Some(noise)) => Some(Bench::new(&self.layout, noise, sum, freedom)?),
            _ => None,
        };
        Some(Benches { delta, sum })
    }

    /// The most likely noise of what is left, from `start` or from a first guess.
    pub fn noises(&self, left: &Left, freedom: &Freedom, start: Option<&Noises>) -> Noises {
        let coarse = start.is_none();
        let first = start.map_or_else(|| first_guess(self.sample_ug, self.ug_per_c), |noises| noises.delta);
        let mut delta = noise(&self.layout, &left.delta, &freedom.delta, first, coarse);
        if coarse && self.layout.may_turn_unseen() {
            delta = self.turned(left, freedom, delta).unwrap_or(delta);
        }
        Noises { delta, sum: self.sum_noise(left, freedom, start) }
    }

    /// The noise of a rig that was turned over unseen, if that makes what was measured more likely.
    fn turned(&self, left: &Left, freedom: &Freedom, without: NoiseModel) -> Option<NoiseModel> {
        let mut start = without;
        [TURN, WANDER].into_iter().for_each(|part| start.parts[part] = self.sample_ug);
        let with = noise(&self.layout, &left.delta, &freedom.delta, start, false);
        let deviance = |noise| Some(Bench::new(&self.layout, noise, &left.delta, &freedom.delta)?.deviance);
        (deviance(with)? + self.price() < deviance(without)?).then_some(with)
    }

    /// The same of the sum alone.
    pub fn sum_noise(&self, left: &Left, freedom: &Freedom, start: Option<&Noises>) -> Option<NoiseModel> {
        let (channel, residual, freedom) = (self.sum.as_ref()?, left.sum.as_ref()?, freedom.sum.as_ref()?);
        let known = start.and_then(|noises| noises.sum);
        let first = known.unwrap_or_else(|| first_guess(channel.sample, channel.per_c));
        Some(noise(&self.layout, residual, freedom, first, start.is_none()))
    }

    /// What a step of each free parameter adds to difference and sum, by numeric differentiation.
    pub fn tangents(&self, held: Option<&Held>, known: &Known) -> (Columns, Option<Columns>) {
        let base = self.left_beside(held, known);
        let parameters = known.coefficients.to_parameters(&known.effects);
        let (mut delta, mut sum) = (Vec::new(), Vec::new());
        for index in 0..parameters.len() {
            let mut stepped = parameters.clone();
            let step = STEP * parameters[index].abs().clamp(1e-4, 1.0);
            stepped[index] += step;
            let moved = self.left_beside(held, &known.at(&stepped));
            delta.push(slope(&moved.delta, &base.delta, step));
            if let (Some(moved), Some(base)) = (&moved.sum, &base.sum) {
                sum.push(slope(moved, base, step));
            }
        }
        (joined(&delta), (!sum.is_empty()).then(|| joined(&sum)))
    }

    /// Fits the parameters of effects beside others that are held, in at most so many steps.
    pub fn refit(&self, held: Option<&Held>, known: &Known, benches: &Benches, steps: usize) -> Known {
        let squares = |known: &Known| {
            let left = self.left_beside(held, known);
            benches.normal(&left.delta, left.sum.as_ref())[(0, 0)]
        };
        let (mut best, mut now, mut damping) = (known.clone(), squares(known), 1e-3);
        for _ in 0..steps {
            let normal = benches.local(self, held, &best);
            let parameters = best.coefficients.to_parameters(&best.effects);
            let mut gained = 0.0;
            while damping < MOST_DAMPING {
                let step = damped_step(&normal, damping).unwrap_or_else(|| DVector::zeros(parameters.len()));
                let next = best.at(&parameters.iter().zip(step.iter()).map(|(p, s)| p + s).collect::<Vec<_>>());
                let value = squares(&next);
                if value < now {
                    gained = now - value;
                    (best, now, damping) = (next, value, damping * 0.1);
                    break;
                }
                damping *= 10.0;
            }
            if gained < REFIT_GAIN {
                break;
            }
        }
        best
    }
}

impl Benches<'_> {
    /// Products of the residual and the tangents of the parameters.
    fn local(&self, case: &Case, held: Option<&Held>, known: &Known) -> DMatrix<f64> {
        let left = case.left_beside(held, known);
        let (delta, sum) = case.tangents(held, known);
        let sums = left.sum.as_ref().zip(sum.as_ref()).map(|(residual, tangents)| stacked(residual, tangents));
        self.normal(&stacked(&left.delta, &delta), sums.as_ref())
    }

    /// Products of columns with each other, beyond what instrument and noise absorb, difference and sum together.
    pub fn normal(&self, delta: &Columns, sum: Option<&Columns>) -> DMatrix<f64> {
        let mut normal = self.delta.score(delta).normal;
        if let (Some(bench), Some(columns)) = (&self.sum, sum) {
            normal += bench.score(columns).normal;
        }
        normal
    }

    /// −2 log likelihood of difference and sum.
    pub fn deviance(&self) -> f64 {
        self.delta.deviance + self.sum.as_ref().map_or(0.0, |bench| bench.deviance)
    }
}

/// Amplitude in the sum of an effect that leaves it free.
const FREE: f64 = 1e2;

/// Columns so large that what they absorb costs nothing.
pub(super) fn generous(columns: &Columns, unit: f64) -> Columns {
    let largest = |column: usize| columns.iter().map(|run| run.column(column).amax()).fold(0.0, f64::max);
    let scale = |column| if largest(column) > 0.0 { GENEROUS * unit / largest(column) } else { 0.0 };
    let scales: Vec<f64> = (0..width(columns)).map(scale).collect();
    let scaled = |run: &DMatrix<f64>| DMatrix::from_fn(run.nrows(), run.ncols(), |i, j| run[(i, j)] * scales[j]);
    columns.iter().map(scaled).collect()
}

/// Of the sample noise: as far as a known effect may move a cell.
const GENEROUS: f64 = 1e3;

fn slope(moved: &Columns, base: &Columns, step: f64) -> Columns {
    difference(moved, base).into_iter().map(|run| run / step).collect()
}

/// Gauss–Newton step from the products of [residual, tangents].
fn damped_step(normal: &DMatrix<f64>, damping: f64) -> Option<DVector<f64>> {
    let count = normal.nrows() - 1;
    let mut inner = normal.view((1, 1), (count, count)).into_owned();
    for i in 0..count {
        inner[(i, i)] = inner[(i, i)] * (1.0 + damping) + f64::MIN_POSITIVE;
    }
    let right: DVector<f64> = -normal.view((1, 0), (count, 1)).column(0);
    Some(inner.cholesky()?.solve(&right))
}
