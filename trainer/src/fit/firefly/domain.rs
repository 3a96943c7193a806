//! The box in which fireflies live: checked once, here, so that no loop has to ask.

use super::error::FireflyError;
use crate::fit::random;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::ops::RangeInclusive;

/// A box: per dimension a finite lower and a finite, larger upper bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Domain {
    /// The box with these bounds.
    ///
    /// # Errors
    /// [`FireflyError::NoDimensions`] without bounds, [`FireflyError::Bounds`] where a width is not a
    /// finite positive number.
    pub fn new(bounds: &[RangeInclusive<f64>]) -> Result<Self, FireflyError> {
        if bounds.is_empty() {
            return Err(FireflyError::NoDimensions);
        }
        for (dimension, bound) in bounds.iter().enumerate() {
            let (lower, upper) = (*bound.start(), *bound.end());
            let width = upper - lower;
            if !(width.is_finite() && width > 0.0) {
                return Err(FireflyError::Bounds { dimension, lower, upper });
            }
        }
        Ok(Self {
            lower: bounds.iter().map(|bound| *bound.start()).collect(),
            upper: bounds.iter().map(|bound| *bound.end()).collect(),
        })
    }

    /// The box with the same bounds in every dimension.
    ///
    /// # Errors
    /// As [`Domain::new`].
    pub fn cube(dimensions: usize, bounds: &RangeInclusive<f64>) -> Result<Self, FireflyError> {
        Self::new(&vec![bounds.clone(); dimensions])
    }

    /// D, the number of dimensions.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        self.lower.len()
    }

    /// s of the paper's eq. (9): the width of one dimension.
    pub(super) fn width(&self, dimension: usize) -> f64 {
        self.upper[dimension] - self.lower[dimension]
    }

    /// The width of each dimension.
    pub fn widths(&self) -> impl Iterator<Item = f64> {
        (0..self.dimensions()).map(|dimension| self.width(dimension))
    }

    /// Eq. (11). The paper prints two cases; the third, a coordinate inside stays, is meant.
    pub fn clamp(&self, position: &mut [f64]) {
        for (x, (lower, upper)) in position.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            *x = x.clamp(*lower, *upper);
        }
    }

    /// A position drawn uniformly.
    pub(super) fn scatter(&self, rng: &mut Xoshiro256PlusPlus) -> Vec<f64> {
        let bounds = self.lower.iter().zip(&self.upper);
        bounds.map(|(lower, upper)| random::between(rng, *lower, *upper)).collect()
    }
}
