//! One campaign and one model before the judge: what is measured, and what a set of effects leaves of it.

use super::evidence::{Bench, difference, joined, stacked, width};
use super::instrument::{Instrument, Known};
use super::layout::{Cell, Layout, Stretch};
use super::left::{Held, Left};
use super::noise_search::{first_guess, noise};
use super::sum_channel::SumChannel;
use super::whitening::{Columns, NoiseModel, TURN, WANDER};
use nalgebra::DMatrix;

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
    /// No effects, to be held.
    pub bare: Held,
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

/// What may still adapt.
#[derive(Clone)]
pub(super) struct Freedom {
    /// What retraining can absorb of the residual.
    pub delta: Columns,
    /// What a change of the sum's map, and effects that don't say what they do to the sum, can absorb of it.
    pub sum: Option<Columns>,
}

/// Both benches under one noise.
pub(super) struct Benches {
    /// For the residual.
    pub delta: Bench,
    /// For the sum.
    pub sum: Option<Bench>,
}

/// Slope of the sum of two forks of silicon near 40 kHz over temperature, 4.8 Hz/°C, where it was not measured; in
/// accelerations that move the difference as far, as nobody knows what the signal's unit is.
const SILICON_G_PER_C: f64 = 4.8 / 420.0;

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
        let hz_per_g = self.instrument.scale_factor_hz_per_g(&self.layout).abs();
        let hz_per_c = match &self.sum {
            Some(sum) => sum.per_c.abs() * 1e-3,
            None => hz_per_g * SILICON_G_PER_C,
        };
        hz_per_g / hz_per_c.max(f64::MIN_POSITIVE)
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

    /// What may adapt around these effects, their own parameters held.
    pub fn stiff(&self, known: &Known) -> Freedom {
        let sum = self.sum.as_ref().map(|channel| {
            let columns: Vec<Columns> = known.untold().each().map(|one| self.alone(&one)).collect();
            if columns.is_empty() { channel.freedom.clone() } else { stacked(&channel.freedom, &joined(&columns)) }
        });
        Freedom { delta: self.freedom.clone(), sum }
    }

    /// What may adapt, the effects' own parameters too, as long as no noise is known.
    pub fn loose(&self, known: &Known) -> Freedom {
        let stiff = self.stiff(known);
        if known.effects.is_empty() {
            return stiff;
        }
        self.widened(&stiff, &self.bare, known, &self.left(known))
    }

    /// What may adapt, the effects' own parameters too as far as the sum of the frequencies leaves them open.
    pub fn adapting(&self, known: &Known, noises: &Noises) -> Freedom {
        let stiff = self.stiff(known);
        if known.effects.is_empty() {
            return stiff;
        }
        let left = self.left(known);
        let tangents = self.tangents(&self.bare, known, &left);
        let mut freedom = self.with_tangents(&stiff, &tangents);
        let told: Vec<usize> = known.tells().enumerate().filter_map(|(place, tells)| tells.then_some(place)).collect();
        let sum = tangents.1.as_ref().filter(|_| !told.is_empty());
        if let Some(open) = self.left_open(&left, &stiff, noises, sum, &told) {
            for (free, delta) in freedom.delta.iter_mut().zip(&tangents.0) {
                let (first, columns) = (free.ncols() - delta.ncols(), delta.select_columns(&told) * &open);
                told.iter().zip(columns.column_iter()).for_each(|(place, own)| free.set_column(first + place, &own));
            }
        }
        freedom
    }

    /// How the sum of the frequencies leaves parameters open that it tells of: a root of their covariance.
    fn left_open(
        &self,
        left: &Left,
        stiff: &Freedom,
        noises: &Noises,
        tangents: Option<&Columns>,
        told: &[usize],
    ) -> Option<DMatrix<f64>> {
        let tangents: Columns = tangents?.iter().map(|run| run.select_columns(told)).collect();
        let bench = Bench::new(&self.layout, noises.sum?, left.sum.as_ref()?, stiff.sum.as_ref()?)?;
        Some(bench.score(&tangents).covariance()?.cholesky()?.unpack())
    }

    /// `freedom`, and the parameters of effects that leave `left` beside others that are held.
    pub fn widened(&self, freedom: &Freedom, held: &Held, own: &Known, left: &Left) -> Freedom {
        self.with_tangents(freedom, &self.tangents(held, own, left))
    }

    fn with_tangents(&self, freedom: &Freedom, (delta, sum): &(Columns, Option<Columns>)) -> Freedom {
        let both = freedom.sum.as_ref().zip(sum.as_ref()).zip(self.sum.as_ref());
        Freedom {
            delta: stacked(&freedom.delta, &generous(delta, self.sample_ug)),
            sum: both.map(|((freedom, sum), channel)| stacked(freedom, &generous(sum, channel.sample))),
        }
    }

    /// The column of effects by themselves, µg, scaled up to be free.
    fn alone(&self, known: &Known) -> Columns {
        let (after, before) = (self.left(known), self.left(&Known::NONE));
        difference(&after.delta, &before.delta).into_iter().map(|run| run * FREE).collect()
    }

    /// The benches for what is left, under `noises`.
    pub fn benches(&self, left: &Left, freedom: &Freedom, noises: &Noises) -> Option<Benches> {
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
}

impl Benches {
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
