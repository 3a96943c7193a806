//! One search on one field, over many seeds.

use super::contender::{Contender, Field};
use super::evolution::Evolution;
use crate::fit::firefly::{FireflyError, Generation, Swarm};
use crate::fit::random::stream;
use rayon::prelude::*;

/// How often a search found what there was to find.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The search.
    pub contender: Contender,
    /// Where it searched.
    pub field: Field,
    /// Evaluations of the function, mean over the seeds.
    pub evaluations: f64,
    /// Where each seed's search ended: best and mean cost of the last generation.
    pub ends: Vec<Generation>,
    /// How it got there; nothing of a search without generations.
    pub evolution: Option<Evolution>,
}

/// Searches with the first `seeds` streams of `seed`. The same on any number of threads.
///
/// # Errors
/// [`FireflyError::Bounds`] for a field without extent.
pub fn trial(contender: Contender, field: Field, seeds: u64, seed: u64) -> Result<Trial, FireflyError> {
    let swarms = (0..seeds)
        .into_par_iter()
        .map(|index| contender.search(&field, &mut stream(seed, index)))
        .collect::<Result<Vec<Swarm>, _>>()?;
    let evaluations: usize = swarms.iter().map(|swarm| swarm.evaluations).sum();
    let end = |swarm: &Swarm| Generation {
        best: swarm.best_cost,
        mean: swarm.history.last().map_or(swarm.best_cost, |last| last.mean),
    };
    let ends = swarms.iter().map(end).collect();
    let histories: Vec<Vec<Generation>> = swarms.into_iter().map(|swarm| swarm.history).collect();
    let evaluations = evaluations as f64 / seeds.max(1) as f64;
    Ok(Trial { contender, field, evaluations, ends, evolution: Evolution::of(&histories) })
}

impl Trial {
    /// Share of the seeds whose best ended in the global minimum's basin.
    #[must_use]
    pub fn found(&self) -> Share {
        self.share(|end| self.field.function.found(end.best))
    }

    /// Share of the seeds in which even the swarm's mean cost ended there.
    #[must_use]
    pub fn gathered(&self) -> Share {
        self.share(|end| self.field.function.found(end.mean))
    }

    /// Share of the seeds that ended as asked.
    pub fn share(&self, asked: impl Fn(&Generation) -> bool) -> Share {
        Share { hits: self.ends.iter().filter(|end| asked(end)).count(), of: self.ends.len() }
    }
}

/// So many of so many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// So many.
    pub hits: usize,
    /// Of so many.
    pub of: usize,
}

impl Share {
    /// From 0 to 1; 0 of none.
    #[must_use]
    pub fn fraction(self) -> f64 {
        if self.of == 0 { 0.0 } else { self.hits as f64 / self.of as f64 }
    }

    /// In per cent.
    #[must_use]
    pub fn percent(self) -> f64 {
        100.0 * self.fraction()
    }

    /// Lower and upper end of Wilson's 95 % interval, per cent. It has a width also at 0 and at 100 %.
    #[must_use]
    pub fn interval_percent(self) -> [f64; 2] {
        if self.of == 0 {
            return [0.0, 100.0];
        }
        let (n, p, z2) = (self.of as f64, self.fraction(), Z95 * Z95);
        let centre = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let half = Z95 / (1.0 + z2 / n) * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
        [centre - half, centre + half].map(|end| (100.0 * end).clamp(0.0, 100.0))
    }

    /// By how many standard deviations this share exceeds another; 0 where neither varies.
    #[must_use]
    pub fn deviations_above(self, other: Self) -> f64 {
        let pooled = Self { hits: self.hits + other.hits, of: self.of + other.of }.fraction();
        let variance = pooled * (1.0 - pooled) * ((self.of as f64).recip() + (other.of as f64).recip());
        if variance > 0.0 { (self.fraction() - other.fraction()) / variance.sqrt() } else { 0.0 }
    }
}

/// Two-sided 95 % of a normal distribution.
const Z95: f64 = 1.96;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::contender::FIELDS;

    #[test]
    fn a_share_knows_how_well_it_is_known() {
        let share = Share { hits: 0, of: 1000 };
        assert_eq!(share.percent(), 0.0);
        let [low, high] = share.interval_percent();
        assert!(low == 0.0 && (0.3..0.5).contains(&high), "the rule of three: {high}");
        assert_eq!(share.deviations_above(share), 0.0);
        let (half, less) = (Share { hits: 500, of: 1000 }, Share { hits: 400, of: 1000 });
        assert!((half.deviations_above(less) - 4.49).abs() < 0.01);
    }

    #[test]
    fn the_same_seed_gives_the_same_ends_and_random_points_make_no_curve() {
        let of = |contender| trial(contender, FIELDS[4], 20, 7).expect("a field with extent");
        assert_eq!(of(Contender::IfaPrinted).ends, of(Contender::IfaPrinted).ends);
        assert_eq!(of(Contender::IfaPrinted).evaluations, of(Contender::RandomPoints).evaluations);
        assert!(of(Contender::RandomPoints).evolution.is_none() && of(Contender::FaPrinted).evolution.is_some());
    }
}
