//! Simulated annealing of the best firefly: eqs. (7) to (10), the paper's second improvement.

use super::flock::Flock;
use super::settings::{Epsilon, ImprovedSettings, Perturbed};
use crate::fit::random;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::FRAC_PI_2;

/// What the perturbation of the best firefly needs to know, with ε in units of the cost.
pub(super) struct Annealing {
    epsilon: f64,
    perturbed: Perturbed,
    maxgen: usize,
}

impl Annealing {
    /// Resolves ε against the initial swarm's costs.
    pub(super) fn new(settings: &ImprovedSettings, costs: impl Iterator<Item = f64>) -> Self {
        let (lowest, highest) = costs
            .filter(|cost| cost.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lowest, highest), cost| (lowest.min(cost), highest.max(cost)));
        let unit = match settings.epsilon {
            Epsilon::Absolute(_) => 1.0,
            _ if lowest > highest => 0.0,
            Epsilon::OfInitialSpread(_) => highest - lowest,
            Epsilon::OfInitialBest(_) => lowest.abs(),
        };
        let (Epsilon::Absolute(epsilon) | Epsilon::OfInitialSpread(epsilon) | Epsilon::OfInitialBest(epsilon)) =
            settings.epsilon;
        Self { epsilon: epsilon * unit, perturbed: settings.perturbed, maxgen: settings.generations }
    }

    /// Perturbs firefly `best` in generation `n`, eqs. (9) and (10), and keeps the new place if eq. (7) says so.
    ///
    /// The paper states eq. (11) for the other fireflies only; it is applied here too, since the perturbation
    /// alone reaches half a width beyond the border.
    pub(super) fn perturb<F: FnMut(&[f64]) -> f64>(&self, flock: &mut Flock<'_, F>, best: usize, n: usize) {
        let mut candidate = flock.fireflies()[best].position.clone();
        let amplitude = amplitude(n, self.maxgen);
        for dimension in chosen(self.perturbed, candidate.len(), flock.rng) {
            let width = flock.domain().width(dimension);
            candidate[dimension] += amplitude * random::centred(flock.rng) * width;
        }
        flock.domain().clamp(&mut candidate);
        let cost = flock.evaluate(&candidate);
        let draw = random::unit(flock.rng);
        let temperature = temperature(self.epsilon, n, self.maxgen);
        if accepts(flock.fireflies()[best].cost, cost, temperature, draw) {
            flock.place(best, &candidate, cost);
        }
    }
}

/// Which of `dimensions` coordinates to perturb.
fn chosen(perturbed: Perturbed, dimensions: usize, rng: &mut Xoshiro256PlusPlus) -> Vec<usize> {
    let mut indices: Vec<usize> = (0..dimensions).collect();
    if let Perturbed::UpTo(most) = perturbed {
        let count = 1 + random::below(rng, most.min(dimensions));
        random::draw(rng, &mut indices, count);
        indices.truncate(count);
    }
    indices
}

/// cos(π/2 · n/maxgen) of eq. (9). Concave: 16 % is left when a tenth of the generations is.
fn amplitude(n: usize, maxgen: usize) -> f64 {
    (FRAC_PI_2 * n as f64 / maxgen as f64).cos()
}

/// T = ε·(maxgen − n), eq. (8).
fn temperature(epsilon: f64, n: usize, maxgen: usize) -> f64 {
    epsilon * maxgen.saturating_sub(n) as f64
}

/// The Metropolis criterion, eq. (7), for costs to be minimised and a `draw` uniform in [0, 1).
///
/// Guards: an equal cost is accepted at any temperature (as printed, exp 0 = 1); at T = 0, where eq. (7)
/// divides by zero, nothing worse is; an infinite cost never replaces a finite one.
fn accepts(cost: f64, candidate: f64, temperature: f64, draw: f64) -> bool {
    candidate <= cost || (temperature > 0.0 && draw < ((cost - candidate) / temperature).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::random::stream;

    #[test]
    fn worse_candidates_are_accepted_with_the_boltzmann_probability() {
        const DRAWS: u32 = 20_000;
        let mut rng = stream(1, 0);
        for (worse_by, temperature) in [(0.1, 0.5), (0.5, 0.5), (1.0, 0.25)] {
            let probability = f64::exp(-worse_by / temperature);
            let accepted =
                (0..DRAWS).filter(|_| accepts(2.0, 2.0 + worse_by, temperature, random::unit(&mut rng))).count() as f64;
            let deviation = (f64::from(DRAWS) * probability * (1.0 - probability)).sqrt();
            let off = (accepted - f64::from(DRAWS) * probability) / deviation;
            assert!(off.abs() < 4.0, "ΔC/T = {worse_by}/{temperature}: {off} standard deviations");
        }
    }

    #[test]
    fn the_criterion_is_defined_everywhere() {
        const LARGEST_DRAW: f64 = 1.0 - f64::EPSILON / 2.0;
        let inf = f64::INFINITY;
        assert!(accepts(1.0, 1.0, 0.0, LARGEST_DRAW), "equal");
        assert!(accepts(1.0, 0.5, 0.0, LARGEST_DRAW), "better");
        assert!(accepts(inf, inf, 1.0, LARGEST_DRAW), "nothing to lose");
        assert!(!accepts(1.0, 1.0 + 1e-15, 0.0, 0.0), "worse at T = 0");
        assert!(!accepts(1.0, inf, 1e300, 0.0), "infinite");
    }

    #[test]
    fn temperature_and_amplitude_fall_to_nothing() {
        assert_eq!(temperature(0.01, 0, 50), 0.5);
        assert_eq!(temperature(0.01, 50, 50), 0.0);
        assert_eq!(amplitude(0, 50), 1.0);
        assert!((amplitude(45, 50) - 0.156).abs() < 1e-3);
        assert!(amplitude(50, 50).abs() < 1e-15);
    }

    #[test]
    fn epsilon_takes_its_unit_from_the_initial_swarm() {
        let resolved = |epsilon, costs: &[f64]| {
            let settings = ImprovedSettings { epsilon, ..ImprovedSettings::paper() };
            Annealing::new(&settings, costs.iter().copied()).epsilon
        };
        let costs = [4.0, f64::INFINITY, 2.0, 10.0];
        assert_eq!(resolved(Epsilon::Absolute(0.5), &costs), 0.5);
        assert_eq!(resolved(Epsilon::OfInitialSpread(0.5), &costs), 4.0);
        assert_eq!(resolved(Epsilon::OfInitialBest(0.5), &costs), 1.0);
        assert_eq!(resolved(Epsilon::OfInitialSpread(0.5), &[f64::INFINITY]), 0.0);
    }

    #[test]
    fn one_to_three_distinct_coordinates_are_perturbed() {
        let mut rng = stream(2, 0);
        let mut sizes = [0_usize; 4];
        for _ in 0..3000 {
            let mut picked = chosen(Perturbed::UpTo(3), 41, &mut rng);
            sizes[picked.len()] += 1;
            picked.sort_unstable();
            assert!(picked.windows(2).all(|pair| pair[0] < pair[1]) && picked.iter().all(|&d| d < 41));
        }
        assert!(sizes[0] == 0 && sizes[1..].iter().all(|&n| n.abs_diff(1000) < 110), "{sizes:?}");
        assert_eq!(chosen(Perturbed::All, 2, &mut rng), [0, 1]);
        assert_eq!(chosen(Perturbed::UpTo(3), 1, &mut rng), [0]);
    }
}
