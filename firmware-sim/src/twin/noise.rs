//! The noise of device and instrument: its terms, and the seeded processes that make it.
//!
//! Apart from the effects because it is always there: it is the floor below which no compensation can go.

use serde::{Deserialize, Serialize};

use crate::limit::{Fault, positive, within};
use crate::twin::counter::Counter;
use crate::twin::random::Random;

/// Noise in the five terms of IEEE Std 952, referred to acceleration, and the resolution of the instrument. 0
/// switches a term off.
///
/// Two-sided density `S(f) = N² + B²/(2πf) + K²/(2πf)²`, Allan variance
/// `σ²(τ) = 3Q²/τ² + N²/τ + 0.441B² + K²τ/3 + R²τ²/2`. Every term is split evenly over the two forks, so the sum of the
/// frequencies carries as much noise as the difference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Noise {
    /// Q: quantisation noise other than the counter's own, µg·s.
    pub quantization_ug_s: f64,
    /// N: white noise (velocity random walk), µg·√s, which is µg/√Hz.
    pub white_ug_sqrt_s: f64,
    /// B: flicker noise (bias instability), µg.
    pub flicker_ug: f64,
    /// K: random walk of the acceleration, µg/√s. It starts at zero with every run.
    pub random_walk_ug_per_sqrt_s: f64,
    /// R: ramp, µg/s. It starts at zero with every run.
    pub ramp_ug_per_s: f64,
    /// Clock of the reciprocal counter, Hz; 0 means no quantisation.
    pub counter_clock_hz: f64,
    /// Gate time of the counter, s.
    pub gate_s: f64,
    /// Noise of the thermometer, K rms.
    pub thermometer_noise_k: f64,
    /// Step of the thermometer, K; 0 means no quantisation.
    pub thermometer_step_k: f64,
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            quantization_ug_s: 0.0,
            white_ug_sqrt_s: 4.0,
            flicker_ug: 1.5,
            random_walk_ug_per_sqrt_s: 0.04,
            ramp_ug_per_s: 0.0,
            counter_clock_hz: 100e6,
            gate_s: 1.0,
            thermometer_noise_k: 0.002,
            thermometer_step_k: 0.001,
        }
    }
}

impl Noise {
    /// A device and an instrument without any noise or quantisation.
    #[must_use]
    pub fn off() -> Self {
        Self {
            quantization_ug_s: 0.0,
            white_ug_sqrt_s: 0.0,
            flicker_ug: 0.0,
            random_walk_ug_per_sqrt_s: 0.0,
            ramp_ug_per_s: 0.0,
            counter_clock_hz: 0.0,
            gate_s: 1.0,
            thermometer_noise_k: 0.0,
            thermometer_step_k: 0.0,
        }
    }

    /// The counter of this instrument.
    #[must_use]
    pub fn counter(&self) -> Counter {
        Counter { clock_hz: self.counter_clock_hz, gate_s: self.gate_s }
    }

    /// Variance of the flicker noise as the twin makes it, bounded by its slowest and fastest component, µg².
    #[must_use]
    pub fn flicker_variance_ug2(&self) -> f64 {
        self.flicker_ug.powi(2) * FLICKER_RATIO.ln() * FLICKER_TERMS as f64 / std::f64::consts::PI
    }

    /// # Errors
    /// The first term that is negative, not finite, or beyond anything that measures.
    pub fn check(&self) -> Result<(), Fault> {
        within("quantization_ug_s", self.quantization_ug_s, 0.0, 1e6)?;
        within("white_ug_sqrt_s", self.white_ug_sqrt_s, 0.0, 1e6)?;
        within("flicker_ug", self.flicker_ug, 0.0, 1e6)?;
        within("random_walk_ug_per_sqrt_s", self.random_walk_ug_per_sqrt_s, 0.0, 1e6)?;
        within("ramp_ug_per_s", self.ramp_ug_per_s, -1e3, 1e3)?;
        if self.counter_clock_hz != 0.0 {
            within("counter_clock_hz", self.counter_clock_hz, 1e5, 1e12)?;
        }
        positive("gate_s", self.gate_s)?;
        within("thermometer_noise_k", self.thermometer_noise_k, 0.0, 10.0)?;
        within("thermometer_step_k", self.thermometer_step_k, 0.0, 10.0)
    }
}

/// Flicker noise is a sum of first-order processes whose time constants grow by this ratio; its density then follows
/// 1/f within a few per cent.
const FLICKER_RATIO: f64 = 4.0;
/// From 0.5 s, below the sampling, to 1.5 days, above most runs.
const FLICKER_TERMS: usize = 10;
const FLICKER_FASTEST_S: f64 = 0.5;

/// The running noise of one fork, in units of acceleration.
#[derive(Clone, Debug)]
pub(crate) struct ForkNoise {
    noise: Noise,
    random: Random,
    time_s: f64,
    walk_ug: f64,
    flicker_ug: [f64; FLICKER_TERMS],
    phase_ug_s: f64,
}

impl ForkNoise {
    /// At the start of a run: flicker in its steady state, random walk and ramp at zero.
    pub(crate) fn new(noise: &Noise, mut random: Random) -> Self {
        let sigma_ug = Self::flicker_term_ug(noise);
        let flicker_ug = std::array::from_fn(|_| sigma_ug * random.normal());
        let phase_ug_s = noise.quantization_ug_s * random.normal();
        Self { noise: noise.clone(), random, time_s: 0.0, walk_ug: 0.0, flicker_ug, phase_ug_s }
    }

    /// The noise of the sample at `time_s`, which must not run backwards, as the whole device would show it, g.
    /// A fork alone shows 1/√2 of it.
    pub(crate) fn sample_g(&mut self, time_s: f64) -> f64 {
        let dt_s = time_s - self.time_s;
        self.time_s = time_s;
        let white_ug = self.noise.white_ug_sqrt_s / self.noise.gate_s.sqrt() * self.random.normal();
        self.walk_ug += self.noise.random_walk_ug_per_sqrt_s * dt_s.sqrt() * self.random.normal();
        self.advance_flicker(dt_s);
        let flicker_ug: f64 = self.flicker_ug.iter().sum();
        (white_ug + self.walk_ug + flicker_ug + self.quantization_ug(dt_s)) * 1e-6
    }

    fn advance_flicker(&mut self, dt_s: f64) {
        let sigma_ug = Self::flicker_term_ug(&self.noise);
        let mut tau_s = FLICKER_FASTEST_S;
        for term_ug in &mut self.flicker_ug {
            let kept = (-dt_s / tau_s).exp();
            *term_ug = *term_ug * kept + sigma_ug * (1.0 - kept * kept).sqrt() * self.random.normal();
            tau_s *= FLICKER_RATIO;
        }
    }

    /// The difference of two phase errors; samples that touch share one, which is what makes the density rise.
    fn quantization_ug(&mut self, dt_s: f64) -> f64 {
        let touching = dt_s <= 1.5 * self.noise.gate_s;
        let before_ug_s = if touching { self.phase_ug_s } else { self.noise.quantization_ug_s * self.random.normal() };
        self.phase_ug_s = self.noise.quantization_ug_s * self.random.normal();
        (self.phase_ug_s - before_ug_s) / self.noise.gate_s
    }

    fn flicker_term_ug(noise: &Noise) -> f64 {
        (noise.flicker_variance_ug2() / FLICKER_TERMS as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 1 << 17;

    fn series_ug(noise: &Noise, seed: u64) -> Vec<f64> {
        let mut fork = ForkNoise::new(noise, Random::stream(seed, "test", 0));
        (1..=SAMPLES).map(|i| fork.sample_g(i as f64) * 1e6).collect()
    }

    /// Allan deviation over non-overlapping blocks.
    fn allan_ug(series: &[f64], block: usize) -> f64 {
        let means: Vec<f64> = series.chunks_exact(block).map(|c| c.iter().sum::<f64>() / block as f64).collect();
        let squares: f64 = means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        (squares / (2.0 * (means.len() - 1) as f64)).sqrt()
    }

    fn assert_allan(noise: &Noise, table: &[(usize, f64)], tolerance: f64) {
        let series = series_ug(noise, 11);
        for &(block, expected) in table {
            let ratio = allan_ug(&series, block) / expected;
            // Relative standard error of an Allan deviation over n blocks is about √(1.5 / n) / 2 … √(1 / n).
            assert!((ratio - 1.0).abs() < tolerance, "τ = {block} s: {ratio} of the expected {expected} µg");
        }
    }

    #[test]
    fn white_noise_falls_with_the_root_of_time() {
        let noise = Noise { white_ug_sqrt_s: 4.0, ..Noise::off() };
        assert_allan(&noise, &[(1, 4.0), (16, 1.0), (256, 0.25)], 0.1);
    }

    #[test]
    fn flicker_noise_has_the_floor_of_the_standard() {
        let noise = Noise { flicker_ug: 1.5, ..Noise::off() };
        assert_allan(&noise, &[(8, 0.996), (64, 0.996), (256, 0.996)], 0.12);
    }

    #[test]
    fn a_random_walk_rises_with_the_root_of_time() {
        let noise = Noise { random_walk_ug_per_sqrt_s: 0.04, ..Noise::off() };
        // K·√(τ/3): 0.04·√(16/3), 0.04·√(256/3).
        assert_allan(&noise, &[(16, 0.0924), (256, 0.3695)], 0.15);
    }

    #[test]
    fn quantisation_noise_falls_with_time() {
        let noise = Noise { quantization_ug_s: 2.0, ..Noise::off() };
        // √3·Q/τ.
        assert_allan(&noise, &[(1, 3.464), (16, 0.2165)], 0.1);
    }

    #[test]
    fn the_variance_that_the_floor_uses_is_the_flicker_noise_made() {
        let noise = Noise { flicker_ug: 1.5, ..Noise::off() };
        // Ensemble of runs: within one run the slow components do not average out.
        let square: f64 = (0..4000)
            .map(|seed| ForkNoise::new(&noise, Random::stream(seed, "test", 1)).sample_g(1.0).powi(2) * 1e12)
            .sum();
        let ratio = square / 4000.0 / noise.flicker_variance_ug2();
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}"); // four standard errors of a variance from 4000 draws
    }
}
