//! How a search typically goes, over all seeds: the paper's figures 3 and 4 without the luck of one seed.

use crate::fit::firefly::Generation;

/// Evolution curves of many seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Evolution {
    /// Quartiles over the seeds of the best cost, generation by generation.
    pub best: Vec<Quartiles>,
    /// Quartiles over the seeds of the swarm's mean cost.
    pub mean: Vec<Quartiles>,
    /// The seed in the middle when all are ranked by where their best, then their mean ended.
    pub median_seed: usize,
    /// That seed's own curve.
    pub typical: Vec<Generation>,
}

/// A quarter of the values lies below, half, three quarters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quartiles {
    /// First quartile.
    pub lower: f64,
    /// Median.
    pub median: f64,
    /// Third quartile.
    pub upper: f64,
}

impl Quartiles {
    /// Of these values, each quartile one of them; `None` of none.
    #[must_use]
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let at = |quarter: usize| values[last * quarter / 4];
        Some(Self { lower: at(1), median: at(2), upper: at(3) })
    }
}

impl Evolution {
    /// Of one history a seed; `None` unless there are generations after the first.
    #[must_use]
    pub fn of(histories: &[Vec<Generation>]) -> Option<Self> {
        let generations = histories.iter().map(Vec::len).min().filter(|&count| count > 1)?;
        let over_seeds = |n: usize, value: fn(&Generation) -> f64| {
            Quartiles::of(histories.iter().map(|history| value(&history[n])).collect())
        };
        let curve = |value| (0..generations).map(|n| over_seeds(n, value)).collect::<Option<Vec<_>>>();
        let end = |seed: &usize| &histories[*seed][generations - 1];
        let mut ranked: Vec<usize> = (0..histories.len()).collect();
        ranked.sort_by(|a, b| {
            let (a, b) = (end(a), end(b));
            a.best.total_cmp(&b.best).then(a.mean.total_cmp(&b.mean))
        });
        let median_seed = ranked[(ranked.len() - 1) / 2];
        Some(Self {
            best: curve(|generation| generation.best)?,
            mean: curve(|generation| generation.mean)?,
            median_seed,
            typical: histories[median_seed].clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_typical_seed_is_the_one_in_the_middle() {
        let history = |end: f64| [1.0, end].map(|cost| Generation { best: cost, mean: cost + 1.0 }).to_vec();
        let evolution = Evolution::of(&[0.5, 0.1, 0.9, 0.3, 0.7].map(history)).expect("two generations");
        assert_eq!((evolution.median_seed, evolution.typical[1].best), (0, 0.5));
        assert_eq!(evolution.best[1], Quartiles { lower: 0.3, median: 0.5, upper: 0.7 });
        assert_eq!(evolution.mean[0], Quartiles { lower: 2.0, median: 2.0, upper: 2.0 });
    }

    #[test]
    fn without_generations_there_is_no_curve() {
        assert_eq!(Evolution::of(&[]), None);
        assert_eq!(Evolution::of(&[vec![Generation { best: 0.0, mean: 0.0 }]]), None);
    }
}
