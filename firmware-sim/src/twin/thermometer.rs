//! The thermometer in the package: noise, then steps.
//!
//! Apart from the thermal network because what the thermometer shows is not what it is.

use crate::twin::noise::Noise;
use crate::twin::random::Random;

/// What the thermometer shows for a true temperature, °C.
pub(crate) fn read_c(noise: &Noise, temperature_c: f64, random: &mut Random) -> f64 {
    let shown_c = temperature_c + noise.thermometer_noise_k * random.normal();
    if noise.thermometer_step_k == 0.0 {
        return shown_c;
    }
    (shown_c / noise.thermometer_step_k).round() * noise.thermometer_step_k
}

/// Standard deviation of what the thermometer adds, K.
pub(crate) fn sigma_k(noise: &Noise) -> f64 {
    noise.thermometer_noise_k.hypot(noise.thermometer_step_k / 12.0_f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_shows_multiples_of_its_step_with_the_stated_scatter() {
        let noise = Noise { thermometer_noise_k: 0.002, thermometer_step_k: 0.001, ..Noise::off() };
        let mut random = Random::stream(5, "thermometer", 0);
        let shown: Vec<f64> = (0..20_000).map(|_| read_c(&noise, 24.9997, &mut random) - 24.9997).collect();
        let rms = (shown.iter().map(|x| x * x).sum::<f64>() / shown.len() as f64).sqrt();
        assert!(
            shown
                .iter()
                .all(|x| ((x + 24.9997) * 1e3).fract().abs().min(1.0) < 1e-6
                    || ((x + 24.9997) * 1e3).fract() > 1.0 - 1e-6)
        );
        assert!((rms / sigma_k(&noise) - 1.0).abs() < 0.02, "{rms}");
    }
}
