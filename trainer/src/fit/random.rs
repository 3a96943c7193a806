//! Random numbers: the few draws that the optimisers need, from one generator that the caller seeds.
//!
//! Separate, because "same seed, same model" is a promise about the exact sequence of draws: it must
//! not change with the taste of a distributions crate.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Bits of an f64's mantissa, the hidden one included.
const MANTISSA_BITS: u32 = 53;

/// An independent generator for restart `index` of a search seeded with `seed`.
///
/// Two rounds of SplitMix64's finaliser mix the pair into one key. The finaliser is a bijection, so two
/// indices of one seed never share a generator; and unlike jumping, restart 10 000 costs as little as
/// restart 0, in whatever order the restarts are made.
#[must_use]
pub fn stream(seed: u64, index: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(mix(mix(seed) ^ index))
}

/// Uniform in [0, 1): the top 53 bits of one draw.
pub fn unit(rng: &mut Xoshiro256PlusPlus) -> f64 {
    const STEP: f64 = 1.0 / (1u64 << MANTISSA_BITS) as f64;
    (rng.next_u64() >> (u64::BITS - MANTISSA_BITS)) as f64 * STEP
}

/// ξ − ½ of the paper's equations: uniform in [−½, ½).
pub fn centred(rng: &mut Xoshiro256PlusPlus) -> f64 {
    unit(rng) - 0.5
}

/// Uniform between `lower` and `upper`; rounding may return `upper` itself, never more.
pub fn between(rng: &mut Xoshiro256PlusPlus, lower: f64, upper: f64) -> f64 {
    (lower + (upper - lower) * unit(rng)).min(upper)
}

/// Uniform among 0, 1, …, `count` − 1; 0 when `count` is 0. One draw; its bias is below `count`/2⁶⁴.
pub fn below(rng: &mut Xoshiro256PlusPlus, count: usize) -> usize {
    ((u128::from(rng.next_u64()) * count as u128) >> u64::BITS) as usize
}

/// Moves `count` items, drawn without replacement, to the front and returns them.
pub fn draw<'a, T>(rng: &mut Xoshiro256PlusPlus, items: &'a mut [T], count: usize) -> &'a [T] {
    let count = count.min(items.len());
    for front in 0..count {
        let chosen = front + below(rng, items.len() - front);
        items.swap(front, chosen);
    }
    &items[..count]
}

/// The finaliser of SplitMix64 after one step of its counter.
fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steele, Lea and Flood's generator started at 0 begins with this number.
    #[test]
    fn the_mixer_is_splitmix64() {
        assert_eq!(mix(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(0x9e37_79b9_7f4a_7c15), 0x6e78_9e6a_a1b9_65f4);
    }

    /// Pins the sequence behind every stored model, as the reference algorithms compute it: an upgrade
    /// that changes it must be noticed.
    #[test]
    fn a_seed_keeps_its_sequence() {
        assert_eq!(stream(1, 2).next_u64(), 13_502_186_381_601_466_101);
    }

    #[test]
    fn streams_of_neighbouring_seeds_and_indices_differ() {
        let mut firsts: Vec<u64> =
            (0..40).flat_map(|seed| (0..40).map(move |index| stream(seed, index).next_u64())).collect();
        firsts.sort_unstable();
        firsts.dedup();
        assert_eq!(firsts.len(), 40 * 40);
    }

    #[test]
    fn parallel_streams_are_uncorrelated() {
        const DRAWS: usize = 20_000;
        let (mut a, mut b) = (stream(7, 0), stream(7, 1));
        let products: f64 = (0..DRAWS).map(|_| centred(&mut a) * centred(&mut b)).sum();
        // Standard deviation of the mean product of two independent uniforms: 1/12/√DRAWS.
        let deviations = products / DRAWS as f64 * 12.0 * (DRAWS as f64).sqrt();
        assert!(deviations.abs() < 4.0, "{deviations} standard deviations");
    }

    #[test]
    fn unit_is_uniform_on_the_half_open_interval() {
        const DRAWS: usize = 40_000;
        let mut rng = stream(3, 0);
        let mut cells = [0_usize; 10];
        for _ in 0..DRAWS {
            let value = unit(&mut rng);
            assert!((0.0..1.0).contains(&value));
            cells[(value * 10.0) as usize] += 1;
        }
        let expected = DRAWS as f64 / 10.0;
        let chi2: f64 = cells.iter().map(|&n| (n as f64 - expected).powi(2) / expected).sum();
        assert!(chi2 < 27.9, "χ² = {chi2}; 27.9 is exceeded once in 1000 by 9 degrees of freedom");
    }

    #[test]
    fn between_never_leaves_its_bounds() {
        let mut rng = stream(4, 0);
        for (lower, upper) in [(-5.12, 5.12), (0.1, 0.1), (1e16, 1e16 + 2.0)] {
            for _ in 0..1000 {
                assert!((lower..=upper).contains(&between(&mut rng, lower, upper)));
            }
        }
    }

    #[test]
    fn draw_takes_each_item_equally_often_and_none_twice() {
        const DRAWS: usize = 9000;
        let mut rng = stream(5, 0);
        let mut taken = [0_usize; 9];
        for _ in 0..DRAWS {
            let mut items: [usize; 9] = std::array::from_fn(|i| i);
            let drawn = draw(&mut rng, &mut items, 3).to_vec();
            assert!(drawn[0] != drawn[1] && drawn[1] != drawn[2] && drawn[0] != drawn[2]);
            drawn.iter().for_each(|&item| taken[item] += 1);
        }
        // Each is drawn with probability 1/3: standard deviation √(9000·2/9) = 45.
        assert!(taken.iter().all(|&n| n.abs_diff(3000) < 4 * 45), "{taken:?}");
    }

    #[test]
    fn drawing_more_than_there_are_takes_all() {
        let mut rng = stream(6, 0);
        assert_eq!(draw(&mut rng, &mut [1, 2], 5).len(), 2);
        assert!(draw(&mut rng, &mut [0; 0], 1).is_empty());
        assert_eq!(below(&mut rng, 0), 0);
    }
}
