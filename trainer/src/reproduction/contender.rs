//! The searches that are compared: the paper's two as printed, other readings of them, and no method at all.

use crate::fit::firefly::{
    Domain, FireflyError, Generation, ImprovedSettings, StandardSettings, StepDecay, Swarm, improved, standard,
};
use crate::fit::test_functions::{RASTRIGIN, SCHAFFER, TestFunction};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde::Serialize;
use std::ops::ControlFlow;

/// A test function on a square domain. The paper states no domain.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// The function.
    pub function: TestFunction,
    /// Each coordinate lies within plus and minus this.
    pub half_width: f64,
}

/// The fields of the comparison, each function from a narrow domain to a wide one; 5.12 is Rastrigin's customary one.
pub const FIELDS: [Field; 8] = [
    Field { function: SCHAFFER, half_width: 1.0 },
    Field { function: SCHAFFER, half_width: 2.0 },
    Field { function: SCHAFFER, half_width: 5.0 },
    Field { function: SCHAFFER, half_width: 10.0 },
    Field { function: RASTRIGIN, half_width: 1.0 },
    Field { function: RASTRIGIN, half_width: 2.0 },
    Field { function: RASTRIGIN, half_width: 5.12 },
    Field { function: RASTRIGIN, half_width: 10.0 },
];

/// Dimensions of the paper's comparison.
const DIMENSIONS: usize = 2;

/// One way to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contender {
    /// The best of as many uniformly random points as the printed IFA evaluates from the same seed.
    RandomPoints,
    /// FA, eqs. (4) and (5) as printed.
    FaPrinted,
    /// IFA, eqs. (4) to (11) as printed.
    IfaPrinted,
    /// The same with eq. (6) read as a schedule instead of a recursion.
    IfaSchedule,
    /// FA with steps and distances in units of the domain: [`StandardSettings::recommended`].
    FaRecommended,
    /// IFA with eq. (6) as a schedule, and in units of the domain: [`ImprovedSettings::recommended`].
    IfaRecommended,
}

impl Contender {
    /// All of them, in the order of the tables.
    pub const ALL: [Self; 6] = [
        Self::RandomPoints,
        Self::FaPrinted,
        Self::IfaPrinted,
        Self::IfaSchedule,
        Self::FaRecommended,
        Self::IfaRecommended,
    ];

    /// What it is called in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RandomPoints => "random points",
            Self::FaPrinted => "FA as printed",
            Self::IfaPrinted => "IFA as printed",
            Self::IfaSchedule => "IFA, eq. (6) a schedule",
            Self::FaRecommended => "FA recommended",
            Self::IfaRecommended => "IFA recommended",
        }
    }

    /// Searches one field once.
    ///
    /// # Errors
    /// [`FireflyError::Bounds`] for a field without extent.
    pub fn search(self, field: &Field, random: &mut Xoshiro256PlusPlus) -> Result<Swarm, FireflyError> {
        let domain = Domain::cube(DIMENSIONS, &(-field.half_width..=field.half_width))?;
        let cost = field.function.cost;
        let watch = |_, _: &Generation| ControlFlow::Continue(());
        let printed = ImprovedSettings::paper();
        let settings = match self {
            Self::FaPrinted => return standard(cost, &domain, &StandardSettings::paper(), random, watch),
            Self::FaRecommended => return standard(cost, &domain, &StandardSettings::recommended(), random, watch),
            Self::RandomPoints => {
                let population = Self::IfaPrinted.search(field, &mut random.clone())?.evaluations;
                // A swarm that is scattered and never moves.
                ImprovedSettings { population, generations: 0, ..printed }
            }
            Self::IfaPrinted => printed,
            Self::IfaSchedule => ImprovedSettings { decay: StepDecay::NonRecursive, ..printed },
            Self::IfaRecommended => ImprovedSettings::recommended(),
        };
        improved(cost, &domain, &settings, random, watch)
    }
}
