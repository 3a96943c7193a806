//! How the paper's training goes.

use crate::fit::firefly::{ImprovedSettings, StandardSettings};
use crate::fit::gradient_descent;

/// Settings of firefly-initialised backpropagation.
#[derive(Clone, Debug, PartialEq)]
pub struct Backprop {
    /// What finds the first weights.
    pub swarm: Swarm,
    /// What improves them.
    pub descent: gradient_descent::Settings,
    /// First weights are sought within plus and minus this.
    pub weight_bound: f64,
}

/// Which firefly algorithm.
#[derive(Clone, Debug, PartialEq)]
pub enum Swarm {
    /// Standard, eqs. (4) and (5).
    Standard(StandardSettings),
    /// Improved, eqs. (4) to (11).
    Improved(ImprovedSettings),
}

impl Backprop {
    /// FA-BP.
    #[must_use]
    pub fn standard() -> Self {
        Self::of(Swarm::Standard(StandardSettings::recommended()))
    }

    /// IFA-BP.
    #[must_use]
    pub fn improved() -> Self {
        Self::of(Swarm::Improved(ImprovedSettings::recommended()))
    }

    /// The paper prints neither learning rate nor number of passes nor the box of the weights.
    fn of(swarm: Swarm) -> Self {
        Self { swarm, descent: gradient_descent::Settings::bold_driver(0.1, 3000), weight_bound: 1.0 }
    }
}
