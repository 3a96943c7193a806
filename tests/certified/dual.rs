//! Forward-mode derivatives: a value and its slopes along each parameter, exact to rounding.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The problem with the most parameters has nine.
pub const MOST_PARAMETERS: usize = 9;

/// A value and its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Dual {
    pub value: f64,
    pub slopes: [f64; MOST_PARAMETERS],
}

impl Dual {
    /// The parameter of this index.
    pub fn parameter(index: usize, value: f64) -> Self {
        let mut slopes = [0.0; MOST_PARAMETERS];
        slopes[index] = 1.0;
        Self { value, slopes }
    }

    /// A function's value, and the chain rule.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, slopes: self.slopes.map(|inner| slope * inner) }
    }

    pub fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }

    pub fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }

    pub fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    pub fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    pub fn atan(self) -> Self {
        self.chain(self.value.atan(), (1.0 + self.value * self.value).recip())
    }

    pub fn square(self) -> Self {
        self * self
    }

    /// A fixed power.
    pub fn powf(self, exponent: f64) -> Self {
        self.chain(self.value.powf(exponent), exponent * self.value.powf(exponent - 1.0))
    }

    /// A power that depends on the parameters; not a number where the base is negative.
    pub fn power(self, exponent: impl Into<Self>) -> Self {
        (exponent.into() * self.ln()).exp()
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Self { value, slopes: [0.0; MOST_PARAMETERS] }
    }
}

impl<T: Into<Dual>> Add<T> for Dual {
    type Output = Self;

    fn add(self, other: T) -> Self {
        let other = other.into();
        Self { value: self.value + other.value, slopes: std::array::from_fn(|i| self.slopes[i] + other.slopes[i]) }
    }
}

impl<T: Into<Dual>> Sub<T> for Dual {
    type Output = Self;

    fn sub(self, other: T) -> Self {
        self + -other.into()
    }
}

impl<T: Into<Dual>> Mul<T> for Dual {
    type Output = Self;

    // The rules of differentiation mix the operators.
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn mul(self, other: T) -> Self {
        let other = other.into();
        let slopes = std::array::from_fn(|i| self.value * other.slopes[i] + self.slopes[i] * other.value);
        Self { value: self.value * other.value, slopes }
    }
}

impl<T: Into<Dual>> Div<T> for Dual {
    type Output = Self;

    // The rules of differentiation mix the operators.
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn div(self, other: T) -> Self {
        let other = other.into();
        let value = self.value / other.value;
        let slopes = std::array::from_fn(|i| (self.slopes[i] - value * other.slopes[i]) / other.value);
        Self { value, slopes }
    }
}

impl Neg for Dual {
    type Output = Self;

    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl Add<Dual> for f64 {
    type Output = Dual;

    fn add(self, other: Dual) -> Dual {
        Dual::from(self) + other
    }
}

impl Sub<Dual> for f64 {
    type Output = Dual;

    fn sub(self, other: Dual) -> Dual {
        Dual::from(self) - other
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;

    fn mul(self, other: Dual) -> Dual {
        Dual::from(self) * other
    }
}
