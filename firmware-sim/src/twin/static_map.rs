//! The effect-free device as a function: acceleration and temperature to frequencies, and exactly back.
//!
//! Apart from the simulation because it is also the judge: a perfect static compensation is the inverse that
//! [`StaticMap`] computes, and nothing can be more right than that.

use crate::twin::truth::Truth;

/// The two forks' frequencies as a function of acceleration and temperature, and the exact inverse of their difference.
#[derive(Clone, Debug)]
pub struct StaticMap {
    reference_c: f64,
    forks: [Fork; 2],
}

/// One fork: `f = f0·√(1 + linear·θ + quadratic·θ² + force·a)`; `force` carries the sign of the fork.
#[derive(Clone, Debug)]
struct Fork {
    f0_hz: f64,
    linear: f64,
    quadratic: f64,
    force: f64,
}

/// Newton's steps towards the inverse; the map is so nearly linear that the third is already exact to rounding.
const NEWTON_STEPS: usize = 6;

impl StaticMap {
    /// The map of a device.
    #[must_use]
    pub fn new(truth: &Truth) -> Self {
        let fork = |f0_hz: f64, sign: f64| {
            let tcf = (truth.tcf_ppm_per_k + sign * truth.tcf_difference_ppm_per_k / 2.0) * 1e-6;
            let bend = truth.stress_quadratic_ppb_per_k2 + sign * truth.stress_quadratic_difference_ppb_per_k2 / 2.0;
            let mean_hz = f64::midpoint(truth.f1_hz, truth.f2_hz);
            let mismatch = sign * truth.scale_factor_mismatch_pct / 200.0;
            Fork {
                f0_hz,
                // Young's modulus and stress add up to twice the frequency's coefficient: h1 = 2·TCF − e1.
                linear: 2.0 * tcf,
                quadratic: (truth.young_quadratic_ppb_per_k2 + bend) * 1e-9,
                force: sign * truth.scale_factor_hz_per_g / mean_hz * (1.0 + mismatch),
            }
        };
        Self { reference_c: truth.reference_temperature_c, forks: [fork(truth.f1_hz, 1.0), fork(truth.f2_hz, -1.0)] }
    }

    /// Both frequencies under `acceleration_g` at one temperature, Hz.
    #[must_use]
    pub fn forks_hz(&self, acceleration_g: f64, temperature_c: f64) -> [f64; 2] {
        self.forks_apart_hz(acceleration_g, [temperature_c; 2], 1.0)
    }

    /// Both frequencies when the forks have temperatures of their own and the force sensitivity is `scale` times
    /// nominal, Hz.
    #[must_use]
    pub fn forks_apart_hz(&self, acceleration_g: f64, temperatures_c: [f64; 2], scale: f64) -> [f64; 2] {
        let frequency =
            |i: usize| self.forks[i].frequency_hz(temperatures_c[i] - self.reference_c, scale * acceleration_g);
        [frequency(0), frequency(1)]
    }

    /// f1 − f2, Hz.
    #[must_use]
    pub fn delta_f_hz(&self, acceleration_g: f64, temperature_c: f64) -> f64 {
        let [f1_hz, f2_hz] = self.forks_hz(acceleration_g, temperature_c);
        f1_hz - f2_hz
    }

    /// The acceleration at which the forks differ by `delta_f_hz` at this temperature, g: what a perfect static
    /// compensation reads.
    #[must_use]
    pub fn acceleration_g(&self, delta_f_hz: f64, temperature_c: f64) -> f64 {
        let mut acceleration_g = 0.0;
        for _ in 0..NEWTON_STEPS {
            let miss_hz = delta_f_hz - self.delta_f_hz(acceleration_g, temperature_c);
            acceleration_g += miss_hz / self.sensitivity_hz_per_g(acceleration_g, temperature_c);
        }
        acceleration_g
    }

    /// Local sensitivity of the perfect static compensation, ∂a/∂Δf, g/Hz.
    #[must_use]
    pub fn slope_g_per_hz(&self, delta_f_hz: f64, temperature_c: f64) -> f64 {
        self.sensitivity_hz_per_g(self.acceleration_g(delta_f_hz, temperature_c), temperature_c).recip()
    }

    /// How the perfect static compensation reacts to the thermometer, ∂a/∂T at constant Δf, g/K.
    #[must_use]
    pub fn slope_g_per_c(&self, delta_f_hz: f64, temperature_c: f64) -> f64 {
        let acceleration_g = self.acceleration_g(delta_f_hz, temperature_c);
        let theta = temperature_c - self.reference_c;
        let [drift1, drift2] = [0, 1].map(|i: usize| self.forks[i].slope_hz_per_c(theta, acceleration_g));
        (drift2 - drift1) / self.sensitivity_hz_per_g(acceleration_g, temperature_c)
    }

    /// K1(T): ∂Δf/∂a at 0 g, Hz/g.
    #[must_use]
    pub fn scale_factor_hz_per_g(&self, temperature_c: f64) -> f64 {
        self.sensitivity_hz_per_g(0.0, temperature_c)
    }

    /// The raw bias: Δf at 0 g in units of K1(T), g.
    #[must_use]
    pub fn bias_g(&self, temperature_c: f64) -> f64 {
        self.delta_f_hz(0.0, temperature_c) / self.scale_factor_hz_per_g(temperature_c)
    }

    /// Bias for a temperature difference of the forks, first minus second, at 0 g, g/K.
    #[must_use]
    pub fn gradient_sensitivity_g_per_k(&self, temperature_c: f64) -> f64 {
        let theta = temperature_c - self.reference_c;
        let [drift1, drift2] = [0, 1].map(|i: usize| self.forks[i].slope_hz_per_c(theta, 0.0));
        f64::midpoint(drift1, drift2) / self.scale_factor_hz_per_g(temperature_c)
    }

    /// Temperature coefficient of the mean frequency, Hz/K.
    #[must_use]
    pub fn mean_slope_hz_per_c(&self, temperature_c: f64) -> f64 {
        let theta = temperature_c - self.reference_c;
        f64::midpoint(self.forks[0].slope_hz_per_c(theta, 0.0), self.forks[1].slope_hz_per_c(theta, 0.0))
    }

    fn sensitivity_hz_per_g(&self, acceleration_g: f64, temperature_c: f64) -> f64 {
        let theta = temperature_c - self.reference_c;
        let [pulled, pushed] = [0, 1].map(|i: usize| self.forks[i].slope_hz_per_g(theta, acceleration_g));
        pulled - pushed
    }
}

impl Fork {
    fn frequency_hz(&self, theta: f64, acceleration_g: f64) -> f64 {
        self.f0_hz * (1.0 + theta * (self.linear + theta * self.quadratic) + self.force * acceleration_g).sqrt()
    }

    fn slope_hz_per_g(&self, theta: f64, acceleration_g: f64) -> f64 {
        self.f0_hz * self.f0_hz * self.force / (2.0 * self.frequency_hz(theta, acceleration_g))
    }

    fn slope_hz_per_c(&self, theta: f64, acceleration_g: f64) -> f64 {
        let slope = self.linear + 2.0 * theta * self.quadratic;
        self.f0_hz * self.f0_hz * slope / (2.0 * self.frequency_hz(theta, acceleration_g))
    }
}

#[cfg(test)]
mod tests;
