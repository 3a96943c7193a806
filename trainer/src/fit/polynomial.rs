//! The calibration that everybody makes first: a polynomial in frequency difference and temperature.
//!
//! It is the baseline that a network must beat, and the campaign's own measurement of the scale
//! factor: its slope ∂a/∂Δf is what the network's slope is held to.

use super::dataset::Datum;
use nalgebra::{DMatrix, DVector};

/// a = Σᵢⱼ cᵢⱼ xⁱ tʲ with its covariance.
#[derive(Clone, Debug)]
pub struct Polynomial {
    degree_x: usize,
    degree_t: usize,
    coefficients: DVector<f64>,
    /// Inverse normal matrix; times the residual variance it is the covariance.
    inverse: DMatrix<f64>,
}

/// Inputs closer than this in scaled units count as one level.
const SAME_LEVEL: f64 = 0.05;
/// Highest powers: the baseline of the field is Δf² · T³.
const MOST_X: usize = 2;
pub(crate) const MOST_T: usize = 3;
/// Directions whose information is below this fraction of the best one are not determined by the data.
const LEAST_INFORMATION: f64 = 1e-12;

impl Polynomial {
    /// Weighted least squares, with no higher powers than the data's distinct levels and temperatures carry.
    #[must_use]
    pub fn fit(data: &[Datum]) -> Self {
        let (degree_x, degree_t) = Self::degrees_for(data);
        Self::fit_degrees(data, degree_x, degree_t)
    }

    /// The same, with data weighted by `weight` and an offset of `offset_variance` (in units of the
    /// variance of a datum of weight one) shared by each run.
    ///
    /// It is the signal that scatters, not the reference: within a run at one position a slope of zero would be never
    /// wrong, and runs may be free to lie off. So the signal is fitted over reference and temperature first, and what that
    /// makes of each reference stands for the signal (classical calibration; Osborne 1991, Int. Stat. Rev. 59, 309).
    #[must_use]
    pub fn fit_mixed(data: &[Datum], weight: impl Fn(&Datum) -> f64 + Copy, offset_variance: f64) -> Self {
        let (degree_x, degree_t) = Self::degrees_for(data);
        let level = levels(data);
        let turned: Vec<Datum> =
            data.iter().map(|datum| Datum { x: level(datum.reference_g), reference_g: datum.x, ..*datum }).collect();
        let terms = Terms::of(data, degree_x, degree_t);
        let signal = Self::solve(&turned, &terms, weight, offset_variance);
        let fitted = |datum: &Datum| Datum { x: signal.evaluate(level(datum.reference_g), datum.t), ..*datum };
        let fitted: Vec<Datum> = data.iter().map(fitted).collect();
        Self::solve(&fitted, &terms, weight, offset_variance)
    }

    /// Weighted least squares with these highest powers.
    #[must_use]
    pub fn fit_degrees(data: &[Datum], degree_x: usize, degree_t: usize) -> Self {
        Self::solve(data, &Terms::of(data, degree_x, degree_t), |datum| datum.weight, 0.0)
    }

    /// Of a sensor that lay still: the slope ∂a/∂x is stated, g, and only the course over temperature is fitted. Left to
    /// itself a fit of a reference that never varies would choose the slope zero, which is never wrong there.
    #[must_use]
    pub fn fit_still(data: &[Datum], slope_g: f64, degree_t: usize) -> Self {
        let rest: Vec<Datum> =
            data.iter().map(|datum| Datum { reference_g: datum.reference_g - slope_g * datum.x, ..*datum }).collect();
        let degree_t = degree_t.min(distinct(&mut data.iter().map(|datum| datum.t)).saturating_sub(1));
        let course = Self::fit_degrees(&rest, 0, degree_t);
        let powers = degree_t + 1;
        let mut coefficients = DVector::zeros(2 * powers);
        coefficients.rows_mut(0, powers).copy_from(&course.coefficients);
        coefficients[powers] = slope_g;
        let mut inverse = DMatrix::zeros(2 * powers, 2 * powers);
        inverse.view_mut((0, 0), (powers, powers)).copy_from(&course.inverse);
        Self { degree_x: 1, degree_t, coefficients, inverse }
    }

    fn degrees_for(data: &[Datum]) -> (usize, usize) {
        let powers = |most: usize, values: &mut dyn Iterator<Item = f64>| most.min(distinct(values).saturating_sub(1));
        let level = levels(data);
        // A level that the temperature moves is still one.
        let powers_x = powers(MOST_X, &mut data.iter().map(|datum| datum.x));
        (
            powers(powers_x, &mut data.iter().map(|datum| level(datum.reference_g))),
            powers(MOST_T, &mut data.iter().map(|datum| datum.t)),
        )
    }

    fn solve(data: &[Datum], terms: &Terms, weight: impl Fn(&Datum) -> f64, offset_variance: f64) -> Self {
        let &Terms { degree_x, degree_t, .. } = terms;
        let count = (degree_x + 1) * (degree_t + 1);
        let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for run in data.chunk_by(|a, b| a.run == b.run) {
            let (mut sum, mut value, mut total) = (DVector::zeros(count), 0.0, 0.0);
            for datum in run {
                let (basis, weight) = (terms.basis(datum), weight(datum));
                normal.ger(weight, &basis, &basis, 1.0);
                right.axpy(weight * datum.reference_g, &basis, 1.0);
                sum.axpy(weight, &basis, 1.0);
                value += weight * datum.reference_g;
                total += weight;
            }
            let shared = -offset_variance / (1.0 + offset_variance * total);
            normal.ger(shared, &sum, &sum, 1.0);
            right.axpy(shared * value, &sum, 1.0);
        }
        let inverse = pseudo_inverse(normal);
        Self { degree_x, degree_t, coefficients: &inverse * right, inverse }
    }

    /// Values of another unit, and x of the other sign if `turned`.
    pub(crate) fn scaled(mut self, factor: f64, turned: bool) -> Self {
        let powers = self.degree_t + 1;
        let sign = |k: usize| if turned && k / powers % 2 == 1 { -1.0 } else { 1.0 };
        self.coefficients = DVector::from_fn(self.coefficients.len(), |k, _| self.coefficients[k] * sign(k) * factor);
        let inverse = &self.inverse;
        self.inverse = DMatrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| inverse[(i, j)] * sign(i) * sign(j));
        self
    }

    /// The value at (x, t), g.
    #[must_use]
    pub fn evaluate(&self, x: f64, t: f64) -> f64 {
        basis(self.degree_x, self.degree_t, x, t).dot(&self.coefficients)
    }

    /// ∂a/∂x at (x, t), g.
    #[must_use]
    pub fn slope(&self, x: f64, t: f64) -> f64 {
        slope_basis(self.degree_x, self.degree_t, x, t).dot(&self.coefficients)
    }

    /// Standard deviation of [`Polynomial::evaluate`] for a residual of `sigma_g` per datum of weight one, g.
    #[must_use]
    pub fn value_sigma(&self, x: f64, t: f64, sigma_g: f64) -> f64 {
        let basis = basis(self.degree_x, self.degree_t, x, t);
        sigma_g * (&self.inverse * &basis).dot(&basis).max(0.0).sqrt()
    }

    /// Standard deviation of [`Polynomial::slope`] for a residual of `sigma_g` per row of weight one, g.
    #[must_use]
    pub fn slope_sigma(&self, x: f64, t: f64, sigma_g: f64) -> f64 {
        let basis = slope_basis(self.degree_x, self.degree_t, x, t);
        sigma_g * (&self.inverse * &basis).dot(&basis).max(0.0).sqrt()
    }

    /// Coefficients of 1, x, t and x·t, g; higher powers are left out.
    #[must_use]
    pub fn bilinear(&self) -> [f64; 4] {
        let of = |i: usize, j: usize| {
            let within = i <= self.degree_x && j <= self.degree_t;
            if within { self.coefficients[i * (self.degree_t + 1) + j] } else { 0.0 }
        };
        [of(0, 0), of(1, 0), of(0, 1), of(1, 1)]
    }

    /// Highest powers of frequency difference and temperature.
    #[must_use]
    pub const fn degrees(&self) -> (usize, usize) {
        (self.degree_x, self.degree_t)
    }
}

/// The products of powers that data carry.
struct Terms {
    degree_x: usize,
    degree_t: usize,
    /// Of each power of x, how many powers of t stand beside it.
    powers_t: Vec<usize>,
}

impl Terms {
    /// A power of the signal changes with temperature only as far as there are levels enough in several parts of the range:
    /// what only a level visited at one temperature tells of a curvature tells nothing of how that goes on.
    fn of(data: &[Datum], degree_x: usize, degree_t: usize) -> Self {
        let level = levels(data);
        let part = |t: f64| (((t + 1.0) / 2.0 * (degree_t + 1) as f64) as usize).min(degree_t);
        let in_part = |index: usize| data.iter().filter(move |datum| part(datum.t) == index);
        let levels: Vec<usize> =
            (0..=degree_t).map(|k| distinct(&mut in_part(k).map(|datum| level(datum.reference_g)))).collect();
        let parts_with = |power: usize| levels.iter().filter(|count| **count > power).count();
        let powers_t = |power: usize| if power == 0 { degree_t + 1 } else { parts_with(power) };
        Self { degree_x, degree_t, powers_t: (0..=degree_x).map(powers_t).collect() }
    }

    /// Zero where the data carry nothing.
    fn basis(&self, datum: &Datum) -> DVector<f64> {
        let mut basis = basis(self.degree_x, self.degree_t, datum.x, datum.t);
        for (beside, powers_t) in basis.as_mut_slice().chunks_mut(self.degree_t + 1).zip(&self.powers_t) {
            beside[*powers_t..].fill(0.0);
        }
        basis
    }
}

fn basis(degree_x: usize, degree_t: usize, x: f64, t: f64) -> DVector<f64> {
    products(degree_x, degree_t, |i| x.powi(i), t)
}

fn slope_basis(degree_x: usize, degree_t: usize, x: f64, t: f64) -> DVector<f64> {
    products(degree_x, degree_t, |i| if i == 0 { 0.0 } else { f64::from(i) * x.powi(i - 1) }, t)
}

fn products(degree_x: usize, degree_t: usize, power_of_x: impl Fn(i32) -> f64, t: f64) -> DVector<f64> {
    let powers = degree_t + 1;
    let term = |k: usize, _| power_of_x((k / powers) as i32) * t.powi((k % powers) as i32);
    DVector::from_fn((degree_x + 1) * powers, term)
}

/// Leaves out directions that the data do not determine, instead of inventing a value for them.
fn pseudo_inverse(normal: DMatrix<f64>) -> DMatrix<f64> {
    let eigen = normal.symmetric_eigen();
    let least = eigen.eigenvalues.max() * LEAST_INFORMATION;
    let inverted = eigen.eigenvalues.map(|value| if value > least { value.recip() } else { 0.0 });
    &eigen.eigenvectors * DMatrix::from_diagonal(&inverted) * eigen.eigenvectors.transpose()
}

/// From a reference to −1 … 1.
fn levels(data: &[Datum]) -> impl Fn(f64) -> f64 + use<> {
    let references_g = || data.iter().map(|datum| datum.reference_g);
    let (low_g, high_g) =
        (references_g().fold(f64::INFINITY, f64::min), references_g().fold(f64::NEG_INFINITY, f64::max));
    let (middle_g, half_g) = (f64::midpoint(low_g, high_g), (high_g - low_g) / 2.0);
    move |reference_g| if half_g > 0.0 { (reference_g - middle_g) / half_g } else { 0.0 }
}

/// How many values are further apart than [`SAME_LEVEL`].
fn distinct(values: &mut dyn Iterator<Item = f64>) -> usize {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let mut count = 0;
    let mut last = f64::NEG_INFINITY;
    for value in sorted {
        if value - last > SAME_LEVEL {
            count += 1;
            last = value;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(x: f64, t: f64) -> Datum {
        Datum { x, t, reference_g: 1.5 * x - 0.3 + 0.2 * t + 0.01 * x * t * t - 0.02 * x * x, weight: 1.0, run: 0 }
    }

    #[test]
    fn it_recovers_a_polynomial_and_its_slope() {
        let rows: Vec<Datum> =
            (0..63).map(|k| row(f64::from(k % 7) / 3.0 - 1.0, f64::from(k / 7) / 4.0 - 1.0)).collect();
        let fit = Polynomial::fit(&rows);
        assert_eq!(fit.degrees(), (2, 3));
        assert!((fit.evaluate(0.37, -0.2) - row(0.37, -0.2).reference_g).abs() < 1e-12);
        assert!((fit.slope(0.5, 0.5) - (1.5 + 0.01 * 0.25 - 0.02)).abs() < 1e-11);
    }

    #[test]
    fn a_sensor_that_lies_still_keeps_the_stated_slope() {
        let still = |t: f64| Datum { reference_g: 0.0, ..row(0.1 * t - 0.02 * t * t, t) };
        let rows: Vec<Datum> = (0..40).map(|k| still(f64::from(k) / 20.0 - 1.0)).collect();
        let fit = Polynomial::fit_still(&rows, 2.0, MOST_T);
        assert!((fit.slope(0.3, 0.4) - 2.0).abs() < 1e-12);
        assert!(rows.iter().all(|row| fit.evaluate(row.x, row.t).abs() < 1e-12));
    }

    #[test]
    fn levels_that_are_not_there_carry_no_power() {
        let rows: Vec<Datum> = (0..20).map(|k| row(f64::from(k % 2), f64::from(k) / 10.0 - 1.0)).collect();
        assert_eq!(Polynomial::fit(&rows).degrees(), (1, 3));
        // Two positions whose signal moves with the temperature are two levels.
        let moved = |datum: &Datum| Datum { x: datum.x + 0.3 * datum.t, reference_g: datum.x.round(), ..*datum };
        assert_eq!(Polynomial::fit(&rows.iter().map(moved).collect::<Vec<_>>()).degrees(), (1, 3));
    }

    #[test]
    fn a_level_visited_at_one_temperature_says_nothing_of_a_curvature_elsewhere() {
        let datum =
            |level: f64, t: f64, wander: f64| Datum { reference_g: level, ..row(0.5 * level + 0.1 * t + wander, t) };
        let two = (0..40).map(|k| datum(f64::from(k % 2) * 2.0 - 1.0, f64::from(k) / 20.0 - 1.0, 0.0));
        let middle = (0..9).map(|k| datum(0.0, 0.3 + 1e-4 * f64::from(k), 1e-4 * f64::from(k)));
        let fit = Polynomial::fit(&two.chain(middle).collect::<Vec<_>>());
        assert_eq!(fit.degrees(), (2, 3));
        for (x, t) in [(-0.6, -1.0), (0.0, 0.0), (0.6, 1.0)] {
            assert!((fit.slope(x, t) / 2.0 - 1.0).abs() < 0.01, "{x} {t}: {}", fit.slope(x, t));
        }
    }

    #[test]
    fn runs_at_one_position_each_that_wander_and_lie_off_keep_the_slope() {
        // A slope of 0.5 between runs, each of which wanders by two hundred times the noise: the wander must not be taken
        // for a signal that the reference did not follow.
        let run = |run: usize| {
            let reference_g = [-0.4, 0.4, 0.0, 0.4][run];
            (0..50).map(move |k| {
                let t = f64::from(k) / 25.0 - 1.0;
                let wander = 0.02 * (f64::from(k) / 9.0 + run as f64).sin();
                Datum { x: 2.0 * reference_g + wander, t, reference_g, weight: 1.0, run }
            })
        };
        let rows: Vec<Datum> = (0..4).flat_map(run).collect();
        for offset_variance in [0.0, 1e2, 1e4] {
            let slope = Polynomial::fit_mixed(&rows, |datum| datum.weight, offset_variance).slope(0.0, 0.0);
            assert!((slope / 0.5 - 1.0).abs() < 0.05, "{offset_variance}: {slope}");
        }
    }
}
