//! What cannot be searched, or not so.

use thiserror::Error;

/// What cannot be searched, or not so.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum FireflyError {
    /// A domain without dimensions.
    #[error("the domain has no dimension; give at least one pair of bounds")]
    NoDimensions,
    /// Bounds that enclose nothing.
    #[error("dimension {dimension} has bounds {lower} to {upper}; the lower must be below the upper, both finite")]
    Bounds {
        /// Counted from 0.
        dimension: usize,
        /// The lower bound found.
        lower: f64,
        /// The upper bound found.
        upper: f64,
    },
    /// A swarm in which nobody can see another.
    #[error("the population is {found}; a swarm needs at least 2 fireflies")]
    Population {
        /// The population found.
        found: usize,
    },
    /// A count of zero where nothing would happen.
    #[error("{name} is 0; it must be at least 1")]
    Count {
        /// The setting.
        name: &'static str,
    },
    /// A factor that is negative or not finite.
    #[error("{name} is {found}; it must be finite and not negative")]
    Number {
        /// The setting.
        name: &'static str,
        /// The value found.
        found: f64,
    },
}
