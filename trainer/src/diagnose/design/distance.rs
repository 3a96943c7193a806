//! How far one hypothesis' course is from the best that another could make of it.

use crate::diagnose::cells::{Columns, difference, joined, stacked, width};
use crate::diagnose::forward::{EffectSet, Jacobian};
use crate::diagnose::problem::{GlsPair, Problem};
use crate::diagnose::selection::Candidate;
use crate::diagnose::thresholds::MOST_SHAPES;
use firmware_core::effect::SumResponse;
use nalgebra::{Cholesky, DMatrix};
use std::borrow::Cow;

/// What a hypothesis predicts, and all that it could predict with other parameters.
pub struct Predicted {
    /// What it adds to the residual, µg: one column.
    course: Pair,
    /// What it could add instead, one way after the other; within a way every column has an amplitude of its own.
    ways: Vec<Pair>,
    /// The most that it is expected to do to the sum of the frequencies; how much, it doesn't say.
    free: Option<Pair>,
}

/// Columns of the difference, µg, and of the sum, mHz, with common amplitudes.
struct Pair {
    delta: Columns,
    sum: Option<Columns>,
}

/// Added to correlations before they are solved: rounding.
const ROUNDING: f64 = 1e-9;

impl Predicted {
    /// Of `own`, one effect, beside what is known.
    pub fn new(problem: &Problem, known: &EffectSet, own: &EffectSet) -> Self {
        let forward = &problem.forward;
        let (fixed, effect) = (forward.fixed(known), &own.effects[0]);
        let (with, without) =
            (forward.residuals_beside(&fixed, own), forward.residuals_beside(&fixed, &EffectSet::NONE));
        let sum = with.sum.as_ref().zip(without.sum.as_ref()).map(|(with, without)| difference(with, without));
        let course = Pair { delta: difference(&with.delta, &without.delta), sum };
        let Jacobian { delta, sum } = forward.jacobian(&fixed, own, &with);
        let near = Pair {
            delta: stacked(&course.delta, &delta),
            sum: course.sum.as_ref().zip(sum.as_ref()).map(|(course, sum)| stacked(course, sum)),
        };
        let far = Candidate::all(problem, std::slice::from_ref(effect));
        let far = if far.len() > MOST_SHAPES { Vec::new() } else { far };
        let far = far.into_iter().map(|one: Candidate| {
            let (delta, sum) = (one.delta(problem).into_owned(), one.sum(problem).map(Cow::into_owned));
            let silent = || delta.iter().map(|run| run * 0.0).collect();
            let sum = course.sum.as_ref().map(|_| sum.unwrap_or_else(silent));
            Pair { delta, sum }
        });
        let free = match effect.about.sum_response {
            SumResponse::Free(most) if course.sum.is_some() => {
                let mhz_per_ug = forward.scale_factor_hz_per_g() * 1e-3;
                let scaled = |factor: f64| course.delta.iter().map(|run| run * factor).collect();
                Some(Pair { delta: scaled(0.0), sum: Some(scaled(most * mhz_per_ug)) })
            }
            _ => None,
        };
        Self { ways: std::iter::once(near).chain(far).collect(), course, free }
    }
}

/// Squared distances of pairs of hypotheses, or of one from no effect, σ². One that can't be predicted is 0 away.
pub fn distances(gls: &GlsPair, predicted: &[Option<Predicted>], pairs: &[(usize, Option<usize>)]) -> Vec<f64> {
    let products = Products::new(gls, predicted);
    let distance = |&(one, other): &(usize, Option<usize>)| {
        let Some(other) = other else { return products.beyond_nothing(one) };
        products.beyond_other(one, other).min(products.beyond_other(other, one))
    };
    pairs.iter().map(distance).collect()
}

/// Products of all columns with each other, beyond what instrument and noise absorb.
struct Products {
    normal: DMatrix<f64>,
    /// Of each hypothesis: the places of its course, of its ways, and of what it leaves free.
    places: Vec<Option<Places>>,
}

struct Places {
    course: usize,
    ways: Vec<Vec<usize>>,
    free: Vec<usize>,
}

impl Products {
    fn new<'a>(gls: &GlsPair, predicted: &'a [Option<Predicted>]) -> Self {
        let mut all: Vec<&'a Pair> = Vec::new();
        let mut next = 0;
        let mut place = |pair: &'a Pair, all: &mut Vec<&'a Pair>| {
            let width = width(&pair.delta);
            all.push(pair);
            next += width;
            (next - width..next).collect::<Vec<usize>>()
        };
        let places = predicted.iter().map(|one| {
            let one = one.as_ref()?;
            Some(Places {
                course: place(&one.course, &mut all)[0],
                ways: one.ways.iter().map(|way| place(way, &mut all)).collect(),
                free: one.free.as_ref().map(|free| place(free, &mut all)).unwrap_or_default(),
            })
        });
        let places = places.collect();
        let delta = joined(all.iter().map(|pair| &pair.delta));
        let sums: Option<Vec<&Columns>> = all.iter().map(|pair| pair.sum.as_ref()).collect();
        let sum = sums.filter(|sums| !sums.is_empty()).map(joined);
        let normal = if all.is_empty() { DMatrix::zeros(0, 0) } else { gls.normal(&delta, sum.as_ref()) };
        Self { normal, places }
    }

    fn beyond_nothing(&self, one: usize) -> f64 {
        self.places[one].as_ref().map_or(0.0, |one| self.beyond(one.course, &[], &one.free))
    }

    fn beyond_other(&self, one: usize, other: usize) -> f64 {
        let (Some(one), Some(other)) = (&self.places[one], &self.places[other]) else { return 0.0 };
        let beyond = |way: &Vec<usize>| {
            let free: Vec<usize> = one.free.iter().chain(&other.free).copied().collect();
            self.beyond(one.course, way, &free)
        };
        other.ways.iter().map(beyond).fold(f64::INFINITY, f64::min)
    }

    /// What is left of a column when others have taken what they can: `free` with any amplitude, `expected` with
    /// amplitudes of about 1 at most.
    fn beyond(&self, column: usize, free: &[usize], expected: &[usize]) -> f64 {
        let own = self.normal[(column, column)];
        // In units of their own size the columns can be told from rounding.
        let size = |i: usize| self.normal[(i, i)].max(0.0).sqrt();
        let present: Vec<usize> = free.iter().chain(expected).copied().filter(|&i| size(i) > 0.0).collect();
        if present.is_empty() || own <= 0.0 {
            return own.max(0.0);
        }
        let price = |i: usize| if expected.contains(&i) { 1.0 / self.normal[(i, i)] } else { 0.0 };
        let ridge = |i: usize, j: usize| if i == j { ROUNDING + price(present[i]) } else { 0.0 };
        let inner = DMatrix::from_fn(present.len(), present.len(), |i, j| {
            self.normal[(present[i], present[j])] / (size(present[i]) * size(present[j])) + ridge(i, j)
        });
        let cross = DMatrix::from_fn(present.len(), 1, |i, _| self.normal[(present[i], column)] / size(present[i]));
        let absorbed = Cholesky::new(inner).map_or(own, |factor| cross.dot(&factor.solve(&cross)));
        (own - absorbed).max(0.0)
    }
}
