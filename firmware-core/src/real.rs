//! The number that a formula is written in: `f32` on the device, `f64` in training.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A floating-point number whose every function is the same software on every target.
pub trait Real:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The value of an `f32`, exactly.
    fn from_f32(value: f32) -> Self;
    /// The nearest value to an integer.
    fn from_i64(value: i64) -> Self;
    /// The nearest `f32`.
    fn to_f32(self) -> f32;
    /// eˣ.
    #[must_use]
    fn exp(self) -> Self;
    /// eˣ − 1, accurate near zero.
    #[must_use]
    fn exp_m1(self) -> Self;
    /// ln(1 + x), accurate near zero.
    #[must_use]
    fn ln_1p(self) -> Self;
    /// √x.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// The value within `low ..= high`.
    #[must_use]
    fn between(self, low: Self, high: Self) -> Self {
        if self < low {
            low
        } else if self > high {
            high
        } else {
            self
        }
    }

    /// Millionths as a number of units.
    fn from_micro(micro: i64) -> Self;
}

macro_rules! real {
    ($type:ty, $exp:path, $exp_m1:path, $ln_1p:path, $sqrt:path, $micro:literal) => {
        #[allow(clippy::cast_lossless, clippy::cast_precision_loss, clippy::cast_possible_truncation)]
        impl Real for $type {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            #[inline]
            fn from_f32(value: f32) -> Self {
                value as Self
            }
            #[inline]
            fn from_i64(value: i64) -> Self {
                /// Apart, or the compiler sees that both ways give the same and takes this one always.
                #[inline(never)]
                fn wide(value: i64) -> $type {
                    value as $type
                }
                // Processors convert 32 bits with one instruction and 64 with a function.
                i32::try_from(value).map_or_else(|_| wide(value), |value| value as Self)
            }
            #[inline]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                $exp_m1(self)
            }
            #[inline]
            fn ln_1p(self) -> Self {
                $ln_1p(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$type>::is_finite(self)
            }
            #[inline]
            fn from_micro(micro: i64) -> Self {
                Self::from_i64(micro) * $micro
            }
        }
    };
}

real!(f32, libm::expf, libm::expm1f, libm::log1pf, libm::sqrtf, 1e-6);
real!(f64, libm::exp, libm::expm1, libm::log1p, libm::sqrt, 1e-6);
