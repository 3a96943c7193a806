//! What can be chosen: each doubtful place of the paper's equations is a field, each reading a variant.
//!
//! There is no `Default`: `paper()` is what is printed, `recommended()` what works, and the caller says which.

use super::domain::Domain;
use super::error::FireflyError;

/// What r² means in eq. (4), β = β₀·exp(−γ r²).
///
/// The paper gives γ = 1 and no unit of length. In two dimensions of width 2 that is harmless; between
/// the 41 weights of a 2-10-1 network in [−1, 1] the mean r² is 27, β is 10⁻¹² and attraction is dead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DistanceScale {
    /// ‖xᵢ − xⱼ‖², as printed.
    Raw,
    /// ‖(xᵢ − xⱼ)/s‖² with s the widths of the domain: independent of units, but it grows with D. Finds
    /// most in two dimensions and attracts too little in 41.
    Width,
    /// ‖(xᵢ − xⱼ)/s‖²/D: 1/6 on average between random positions, in any domain.
    Domain,
}

/// The unit of the step α in eq. (5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepScale {
    /// The coordinates' own, as printed.
    Raw,
    /// The width of the domain, dimension by dimension.
    Domain,
}

/// How the step shrinks with the generation n = 0, 1, … of `maxgen`: the reading of eq. (6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepDecay {
    /// α = α₀, the standard algorithm.
    Constant,
    /// α(n+1) = k·α(n)·exp(n/(n − maxgen)), as printed. The factors multiply up: with k = 1 and 50
    /// generations 0.36 of the step is left at n = 10 and 0.0055 at n = 20, so the swarm freezes early.
    Recursive,
    /// α(n) = k·α₀·exp(n/(n − maxgen)): 0.78 at n = 10, 0.51 at n = 20, 0.37 half way, 0 at the end.
    NonRecursive,
}

impl StepDecay {
    /// α(n)/α₀ with adjustment factor `k`. From `maxgen` on, where eq. (6) divides by zero, its limit 0.
    #[must_use]
    pub fn factor(self, k: f64, n: usize, maxgen: usize) -> f64 {
        let printed = |n: usize| {
            let left = maxgen.saturating_sub(n) as f64;
            if left > 0.0 { k * (-(n as f64) / left).exp() } else { 0.0 }
        };
        match self {
            Self::Constant => 1.0,
            Self::Recursive => (0..n).map(printed).product(),
            Self::NonRecursive => printed(n),
        }
    }
}

/// ε of eq. (8), T = ε·(maxgen − n). It has the unit of the cost, which the paper leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Epsilon {
    /// In units of the cost.
    Absolute(f64),
    /// In units of the initial swarm's highest minus lowest finite cost.
    OfInitialSpread(f64),
    /// In units of the magnitude of the initial swarm's lowest cost: a network's first mean square error.
    OfInitialBest(f64),
}

/// Which coordinates of the best firefly eq. (9) perturbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Perturbed {
    /// All of them, as printed. In 41 dimensions hardly any such leap is accepted.
    All,
    /// 1 to this many, number and choice drawn anew each time.
    UpTo(usize),
}

/// Eq. (4): how strongly a firefly is drawn to a brighter one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attraction {
    /// β₀, the attractiveness at no distance.
    pub beta0: f64,
    /// γ, the absorption per unit of r².
    pub gamma: f64,
    /// What r² means.
    pub distance: DistanceScale,
}

impl Attraction {
    /// The paper's β₀ = γ = 1 with a chosen meaning of r².
    #[must_use]
    pub fn unit(distance: DistanceScale) -> Self {
        Self { beta0: 1.0, gamma: 1.0, distance }
    }

    /// β = β₀·exp(−γ r²) between two positions, eq. (4).
    #[must_use]
    pub fn strength(&self, domain: &Domain, from: &[f64], to: &[f64]) -> f64 {
        let differences = from.iter().zip(to).map(|(a, b)| a - b);
        let r2: f64 = match self.distance {
            DistanceScale::Raw => differences.map(|d| d * d).sum(),
            DistanceScale::Width | DistanceScale::Domain => {
                differences.zip(domain.widths()).map(|(d, s)| (d / s) * (d / s)).sum()
            }
        };
        let dimensions = match self.distance {
            DistanceScale::Raw | DistanceScale::Width => 1.0,
            DistanceScale::Domain => domain.dimensions() as f64,
        };
        self.beta0 * (-self.gamma * r2 / dimensions).exp()
    }
}

/// The standard algorithm, eqs. (4) and (5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardSettings {
    /// Number of fireflies, at least 2.
    pub population: usize,
    /// maxgen; 0 returns the best of the initial swarm.
    pub generations: usize,
    /// Eq. (4).
    pub attraction: Attraction,
    /// α₀ of eq. (5).
    pub alpha0: f64,
    /// The unit of α₀.
    pub step_scale: StepScale,
    /// Whether eq. (11) keeps the fireflies inside. The paper introduces it with the improvements.
    pub clamp: bool,
    /// Return the best firefly ever seen instead of the best of the last generation.
    pub archive: bool,
}

impl StandardSettings {
    /// As printed, with the numbers of §2.2.3.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            population: 10,
            generations: 50,
            attraction: Attraction::unit(DistanceScale::Raw),
            alpha0: 0.25,
            step_scale: StepScale::Raw,
            clamp: true,
            archive: false,
        }
    }

    /// Steps and distances in units of the domain, and the best firefly kept.
    #[must_use]
    pub fn recommended() -> Self {
        Self {
            attraction: Attraction::unit(DistanceScale::Domain),
            step_scale: StepScale::Domain,
            archive: true,
            ..Self::paper()
        }
    }

    pub(super) fn check(&self) -> Result<(), FireflyError> {
        check_population(self.population)?;
        check_attraction(&self.attraction)?;
        check_number("alpha0", self.alpha0)
    }
}

/// The improved algorithm, eqs. (4) to (11).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImprovedSettings {
    /// Number of fireflies, at least 2.
    pub population: usize,
    /// maxgen; 0 returns the best of the initial swarm.
    pub generations: usize,
    /// Eq. (4).
    pub attraction: Attraction,
    /// α₀ of eq. (5).
    pub alpha0: f64,
    /// The unit of α₀.
    pub step_scale: StepScale,
    /// The reading of eq. (6).
    pub decay: StepDecay,
    /// k of eq. (6): about 1; the recursive form tolerates up to 1.3.
    pub k: f64,
    /// q, the number of other fireflies that each one compares itself with: "several" in the paper.
    pub selected: usize,
    /// ε of eq. (8).
    pub epsilon: Epsilon,
    /// Which coordinates eq. (9) perturbs.
    pub perturbed: Perturbed,
    /// Return the best firefly ever seen. Without it a worse one that eq. (7) accepted may be returned.
    pub archive: bool,
}

impl ImprovedSettings {
    /// As printed, with the numbers of §2.2.3. The paper does not print k, q and ε; see the [module](super).
    #[must_use]
    pub fn paper() -> Self {
        Self {
            population: 10,
            generations: 50,
            attraction: Attraction::unit(DistanceScale::Raw),
            alpha0: 0.25,
            step_scale: StepScale::Raw,
            decay: StepDecay::Recursive,
            k: 1.0,
            selected: 3,
            epsilon: Epsilon::Absolute(0.01),
            perturbed: Perturbed::All,
            archive: false,
        }
    }

    /// Scaled by the domain and by the cost, decaying without recursion, perturbing few coordinates,
    /// and keeping the best firefly.
    #[must_use]
    pub fn recommended() -> Self {
        Self {
            attraction: Attraction::unit(DistanceScale::Domain),
            step_scale: StepScale::Domain,
            decay: StepDecay::NonRecursive,
            epsilon: Epsilon::OfInitialBest(0.001),
            perturbed: Perturbed::UpTo(3),
            archive: true,
            ..Self::paper()
        }
    }

    pub(super) fn check(&self) -> Result<(), FireflyError> {
        check_population(self.population)?;
        check_attraction(&self.attraction)?;
        check_count("selected", self.selected)?;
        if let Perturbed::UpTo(count) = self.perturbed {
            check_count("perturbed", count)?;
        }
        let (Epsilon::Absolute(epsilon) | Epsilon::OfInitialSpread(epsilon) | Epsilon::OfInitialBest(epsilon)) =
            self.epsilon;
        check_number("epsilon", epsilon)?;
        check_number("alpha0", self.alpha0)?;
        check_number("k", self.k)
    }
}

fn check_population(population: usize) -> Result<(), FireflyError> {
    if population < 2 {
        return Err(FireflyError::Population { found: population });
    }
    Ok(())
}

fn check_attraction(attraction: &Attraction) -> Result<(), FireflyError> {
    check_number("beta0", attraction.beta0)?;
    check_number("gamma", attraction.gamma)
}

fn check_count(name: &'static str, found: usize) -> Result<(), FireflyError> {
    if found == 0 {
        return Err(FireflyError::Count { name });
    }
    Ok(())
}

fn check_number(name: &'static str, found: f64) -> Result<(), FireflyError> {
    if !(found.is_finite() && found >= 0.0) {
        return Err(FireflyError::Number { name, found });
    }
    Ok(())
}
