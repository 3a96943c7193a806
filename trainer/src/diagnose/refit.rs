//! Fits the parameters of effects to what is measured, instrument and noise in the way: Gauss–Newton steps, damped
//! (Levenberg 1944; Marquardt 1963).

use super::case::{Benches, Case};
use super::evidence::{difference, joined, stacked};
use super::instrument::Known;
use super::left::{Held, Left};
use super::whitening::Columns;
use nalgebra::{DMatrix, DVector};

/// Step of numeric derivatives: of logarithms and °C as it is, of amplitudes times their size.
const STEP: f64 = 1e-4;
/// A fit ends when a step gains less than this.
const LEAST_GAIN: f64 = 0.02;
const MOST_DAMPING: f64 = 1e6;

/// What stays the same during a fit.
struct Fit<'a> {
    case: &'a Case<'a>,
    held: &'a Held,
    benches: &'a Benches,
    /// Whether the sum of the frequencies has a say: it has none in effects that don't say what they do to it.
    tells: bool,
}

/// Effects, what they leave, and how much that is.
struct Place {
    known: Known,
    left: Left,
    squares: f64,
}

impl Case<'_> {
    /// Fits the parameters of effects beside others that are held, in at most so many steps; and what they leave.
    pub fn refit(&self, held: &Held, known: &Known, benches: &Benches, steps: usize) -> (Known, Left) {
        let fit = Fit { case: self, held, benches, tells: !known.told().effects.is_empty() };
        let (mut best, mut damping) = (fit.place(known.clone()), 1e-3);
        for _ in 0..steps {
            let before = best.squares;
            best = fit.improved(best, &mut damping);
            if before - best.squares < LEAST_GAIN {
                break;
            }
        }
        (best.known, best.left)
    }

    /// What a step of each free parameter adds to difference and sum, from where these effects leave `base`; by numeric
    /// differentiation.
    pub fn tangents(&self, held: &Held, known: &Known, base: &Left) -> (Columns, Option<Columns>) {
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
}

impl Fit<'_> {
    fn place(&self, known: Known) -> Place {
        let left = self.case.left_beside(self.held, &known);
        let squares = self.benches.normal(&left.delta, left.sum.as_ref().filter(|_| self.tells))[(0, 0)];
        Place { known, left, squares }
    }

    /// One step on, or where it was if no step is any better.
    fn improved(&self, from: Place, damping: &mut f64) -> Place {
        let normal = self.normal(&from);
        let parameters = from.known.coefficients.to_parameters(&from.known.effects);
        while *damping < MOST_DAMPING {
            let step = damped_step(&normal, *damping).unwrap_or_else(|| DVector::zeros(parameters.len()));
            let stepped: Vec<f64> = parameters.iter().zip(step.iter()).map(|(p, s)| p + s).collect();
            let next = self.place(from.known.at(&stepped));
            if next.squares < from.squares {
                *damping *= 0.1;
                return next;
            }
            *damping *= 10.0;
        }
        from
    }

    /// Products of the residual and the tangents of the parameters.
    fn normal(&self, place: &Place) -> DMatrix<f64> {
        let (delta, sum) = self.case.tangents(self.held, &place.known, &place.left);
        let sums = place.left.sum.as_ref().zip(sum.as_ref()).filter(|_| self.tells);
        let sums = sums.map(|(residual, tangents)| stacked(residual, tangents));
        self.benches.normal(&stacked(&place.left.delta, &delta), sums.as_ref())
    }
}

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
