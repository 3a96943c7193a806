//! The fireflies of a running search and their movement, eqs. (4), (5) and (11).

use super::domain::Domain;
use super::settings::{Attraction, StepScale};
use crate::fit::random;
use rand_xoshiro::Xoshiro256PlusPlus;

/// One position and its cost. Bright means cheap.
#[derive(Clone, Debug)]
pub(super) struct Firefly {
    pub(super) position: Vec<f64>,
    pub(super) cost: f64,
}

/// How fireflies move in one generation.
pub(super) struct Movement {
    pub(super) attraction: Attraction,
    /// α per dimension, in the coordinates' units.
    pub(super) step: Vec<f64>,
    /// How many others each firefly compares itself with, drawn anew; all of them without a number.
    pub(super) selected: Option<usize>,
    /// This one keeps its place: its turn was the perturbation.
    pub(super) anchored: Option<usize>,
    /// Whether eq. (11) applies.
    pub(super) clamp: bool,
}

/// The swarm, the objective and the generator.
pub(super) struct Flock<'a, F> {
    pub(super) rng: &'a mut Xoshiro256PlusPlus,
    domain: &'a Domain,
    objective: F,
    fireflies: Vec<Firefly>,
    /// The generation before: eq. (5) refers to X(n) of every firefly.
    previous: Vec<Firefly>,
    best_seen: Firefly,
    evaluations: usize,
    others: Vec<usize>,
}

impl<'a, F: FnMut(&[f64]) -> f64> Flock<'a, F> {
    /// Scatters `population` fireflies uniformly over the domain.
    pub(super) fn scatter(
        population: usize,
        domain: &'a Domain,
        objective: F,
        rng: &'a mut Xoshiro256PlusPlus,
    ) -> Self {
        let mut flock = Self {
            rng,
            domain,
            objective,
            fireflies: Vec::with_capacity(population),
            previous: Vec::new(),
            best_seen: Firefly { position: Vec::new(), cost: f64::INFINITY },
            evaluations: 0,
            others: Vec::with_capacity(population),
        };
        for _ in 0..population {
            let position = domain.scatter(flock.rng);
            let cost = flock.evaluate(&position);
            flock.fireflies.push(Firefly { position, cost });
        }
        flock.previous.clone_from(&flock.fireflies);
        flock
    }

    /// The cost at `position`; what is not a number counts as infinite. Remembers the best.
    pub(super) fn evaluate(&mut self, position: &[f64]) -> f64 {
        self.evaluations += 1;
        let cost = (self.objective)(position);
        let cost = if cost.is_nan() { f64::INFINITY } else { cost };
        if cost < self.best_seen.cost || self.best_seen.position.is_empty() {
            self.best_seen = Firefly { position: position.to_vec(), cost };
        }
        cost
    }

    /// Moves every firefly but the anchored one towards the brighter ones, eq. (5).
    ///
    /// Readings: all comparisons and all targets X_j are those of the previous generation. The sum over
    /// brighter fireflies is walked: each pull, with its own ξ, starts where the one before has led. (The
    /// sum of all pulls from X_i(n), the other reading, overshoots when β is near 1: on Rastrigin's function
    /// within |x| ≤ 1 it finds the global basin half as often.) ξ is a vector. A firefly that sees no
    /// brighter one stays, so the best of the standard algorithm does not move.
    pub(super) fn advance(&mut self, movement: &Movement) {
        for (old, new) in self.previous.iter_mut().zip(&self.fireflies) {
            old.position.copy_from_slice(&new.position);
            old.cost = new.cost;
        }
        for index in 0..self.fireflies.len() {
            if movement.anchored != Some(index) {
                self.fly(index, movement);
            }
        }
    }

    fn fly(&mut self, index: usize, movement: &Movement) {
        let brightness = self.previous[index].cost;
        let mut position = self.previous[index].position.clone();
        let mut pulled = false;
        self.select(index, movement.selected);
        for &other in &self.others {
            let target = &self.previous[other];
            if target.cost < brightness {
                pull(&mut position, &target.position, movement, self.domain, self.rng);
                pulled = true;
            }
        }
        if !pulled {
            return;
        }
        if movement.clamp {
            self.domain.clamp(&mut position);
        }
        let cost = self.evaluate(&position);
        self.place(index, &position, cost);
    }

    /// Lists in `others` whom firefly `index` looks at, in scan order or, when selected, in drawn order.
    fn select(&mut self, index: usize, selected: Option<usize>) {
        self.others.clear();
        self.others.extend((0..self.fireflies.len()).filter(|&other| other != index));
        if let Some(count) = selected {
            random::draw(self.rng, &mut self.others, count);
            self.others.truncate(count);
        }
    }

    /// Puts firefly `index` somewhere else.
    pub(super) fn place(&mut self, index: usize, position: &[f64], cost: f64) {
        self.fireflies[index].position.copy_from_slice(position);
        self.fireflies[index].cost = cost;
    }

    /// The brightest of the present generation, the first among equals.
    pub(super) fn brightest(&self) -> usize {
        (1..self.fireflies.len())
            .fold(0, |best, index| if self.fireflies[index].cost < self.fireflies[best].cost { index } else { best })
    }

    pub(super) fn mean_cost(&self) -> f64 {
        let sum: f64 = self.costs().sum();
        sum / self.fireflies.len() as f64
    }

    pub(super) fn costs(&self) -> impl Iterator<Item = f64> {
        self.fireflies.iter().map(|firefly| firefly.cost)
    }

    pub(super) fn fireflies(&self) -> &[Firefly] {
        &self.fireflies
    }

    pub(super) fn best_seen(&self) -> &Firefly {
        &self.best_seen
    }

    pub(super) fn domain(&self) -> &'a Domain {
        self.domain
    }

    pub(super) fn evaluations(&self) -> usize {
        self.evaluations
    }
}

/// One term of eq. (5): X_i + β·(X_j − X_i) + α·(ξ − ½).
fn pull(position: &mut [f64], target: &[f64], movement: &Movement, domain: &Domain, rng: &mut Xoshiro256PlusPlus) {
    let beta = movement.attraction.strength(domain, position, target);
    for ((x, goal), alpha) in position.iter_mut().zip(target).zip(&movement.step) {
        *x += beta * (goal - *x) + alpha * random::centred(rng);
    }
}

/// α per dimension for a step of `alpha` in units of `scale`.
pub(super) fn step(alpha: f64, scale: StepScale, domain: &Domain) -> Vec<f64> {
    match scale {
        StepScale::Raw => vec![alpha; domain.dimensions()],
        StepScale::Domain => domain.widths().map(|width| alpha * width).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::DistanceScale;
    use super::*;
    use crate::fit::random::stream;

    /// Where three fireflies at 0, 1 and 4, the darker the farther, go when β is ½ and α is 0.
    fn moved(selected: Option<usize>, anchored: Option<usize>) -> [f64; 3] {
        let domain = Domain::new(&[0.0..=4.0]).unwrap();
        let mut rng = stream(1, 0);
        let mut flock = Flock::scatter(3, &domain, |x: &[f64]| x[0], &mut rng);
        for (index, x) in [0.0, 1.0, 4.0].into_iter().enumerate() {
            flock.place(index, &[x], x);
        }
        let mut attraction = Attraction::unit(DistanceScale::Raw);
        (attraction.beta0, attraction.gamma) = (0.5, 0.0);
        flock.advance(&Movement {
            attraction,
            step: step(0.0, StepScale::Domain, &domain),
            selected,
            anchored,
            clamp: true,
        });
        std::array::from_fn(|index| flock.fireflies()[index].position[0])
    }

    /// The last one is led to 2 by the first, then from there half way to where the second has been.
    #[test]
    fn each_pull_starts_where_the_one_before_has_led_and_aims_at_the_previous_generation() {
        assert_eq!(moved(None, None), [0.0, 0.5, 1.5]);
        assert_eq!(moved(None, Some(1)), [0.0, 1.0, 1.5]);
    }

    #[test]
    fn with_one_other_selected_there_is_at_most_one_pull() {
        let [first, second, third] = moved(Some(1), None);
        assert!(first == 0.0 && [0.5, 1.0].contains(&second));
        assert!([2.0, 2.5].contains(&third));
    }

    #[test]
    fn the_step_takes_each_dimensions_width() {
        let domain = Domain::new(&[-1.0..=1.0, 0.0..=100.0]).unwrap();
        assert_eq!(step(0.25, StepScale::Raw, &domain), [0.25, 0.25]);
        assert_eq!(step(0.25, StepScale::Domain, &domain), [0.5, 25.0]);
    }
}
