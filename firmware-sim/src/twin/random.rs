//! Seeded randomness, one independent stream a purpose.
//!
//! Apart from the rest so that switching one effect on never changes another's draws: two campaigns of one seed differ
//! by the effect alone.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const FNV_PRIME: u64 = 0x0000_0100_0000_01b3;

/// A stream of random numbers that depends on the seed, the purpose and the index, and on nothing else.
#[derive(Clone, Debug)]
pub struct Random {
    generator: Xoshiro256PlusPlus,
    spare: Option<f64>,
}

impl Random {
    /// The stream of `seed` for one `purpose`, such as an effect's name, and one `index`, such as the run's number.
    #[must_use]
    pub fn stream(seed: u64, purpose: &str, index: u64) -> Self {
        let bytes = purpose.bytes().chain(index.to_le_bytes()).chain(seed.to_le_bytes());
        let hash = bytes.fold(FNV_OFFSET, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(FNV_PRIME));
        Self { generator: Xoshiro256PlusPlus::seed_from_u64(hash), spare: None }
    }

    /// Sixty-four random bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Uniform in [0, 1), 53 bits.
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Standard normal: Marsaglia's polar method, whose second value is kept for the next call.
    pub fn normal(&mut self) -> f64 {
        if let Some(value) = self.spare.take() {
            return value;
        }
        loop {
            let (u, v) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let square = u * u + v * v;
            if square > 0.0 && square < 1.0 {
                let factor = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(v * factor);
                return u * factor;
            }
        }
    }

    /// A whole number below `bound`, which must not be zero. The modulo bias is below 2⁻⁵⁰ for any list in a scenario.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }

    /// Between two positive numbers, evenly on a logarithmic scale.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.uniform())
    }

    /// −1 or +1.
    pub fn sign(&mut self) -> f64 {
        if self.bits() & 1 == 0 { -1.0 } else { 1.0 }
    }

    /// Puts `items` into random order (Fisher–Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_repeats_and_differs_from_every_other() {
        let mut first = Random::stream(7, "noise", 0);
        assert_eq!(first.clone().bits(), Random::stream(7, "noise", 0).bits());
        let value = first.bits();
        for other in [(8, "noise", 0), (7, "turn-on", 0), (7, "noise", 1)] {
            assert_ne!(value, Random::stream(other.0, other.1, other.2).bits(), "{other:?}");
        }
    }

    #[test]
    fn normals_have_mean_zero_variance_one_and_gaussian_tails() {
        const DRAWS: usize = 200_000;
        let mut random = Random::stream(1, "test", 0);
        let draws: Vec<f64> = (0..DRAWS).map(|_| random.normal()).collect();
        let mean = draws.iter().sum::<f64>() / DRAWS as f64;
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / DRAWS as f64;
        let kurtosis = draws.iter().map(|x| x.powi(4)).sum::<f64>() / DRAWS as f64;
        // Five standard errors: 1/√n, √(2/n), √(96/n).
        assert!(mean.abs() < 0.011 && (variance - 1.0).abs() < 0.016 && (kurtosis - 3.0).abs() < 0.11);
    }

    #[test]
    fn shuffling_keeps_every_item() {
        let mut items: Vec<usize> = (0..24).collect();
        Random::stream(3, "order", 0).shuffle(&mut items);
        assert_ne!(items, (0..24).collect::<Vec<_>>());
        items.sort_unstable();
        assert_eq!(items, (0..24).collect::<Vec<_>>());
    }
}
