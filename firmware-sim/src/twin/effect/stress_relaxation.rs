//! `stress-relaxation`: the die attach creeps after every change of temperature.
//!
//! ```text
//! dq/dt = dT/dt − q/τ(T)        ΔB = b·q        τ(T) = τ0·e^(E_a/k·(1/T − 1/T0))
//! ```
//!
//! Stress of the package: both forks shift together, and their mismatch shows as bias. Power-off does not reset it.
//! Typical: b 1–50 µg/K, τ 10²–10⁶ s; 100 minutes have been measured. The Arrhenius term is off by default; 0.2–0.5
//! eV is common. Moreira et al., INERTIAL 2020; Materials 10, 1077.

use serde::{Deserialize, Serialize};

use super::{Effect, STRESS_MISMATCH, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Forks};
use crate::twin::random::Random;

/// Parameters of `stress-relaxation`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StressRelaxation {
    /// b: bias right after a fast change by 1 K, µg/K.
    pub ug_per_k: f64,
    /// τ0: time constant at the reference temperature, s.
    pub tau_s: f64,
    /// E_a: activation energy, eV; 0 means the same time constant at every temperature.
    pub activation_energy_ev: f64,
}

impl Default for StressRelaxation {
    fn default() -> Self {
        Self { ug_per_k: 5.0, tau_s: 6000.0, activation_energy_ev: 0.0 }
    }
}

impl Switch for StressRelaxation {
    const NAME: &'static str = "stress-relaxation";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_k", self.ug_per_k, -1e5, 1e5)?;
        positive("tau_s", self.tau_s)?;
        within("activation_energy_ev", self.activation_energy_ev, 0.0, 2.0)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { ug_per_k: self.ug_per_k * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { tau_s: random.log_between(2e3, 3e4), ..self.scaled(random.sign()) }
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let reference_c = setting.truth.reference_temperature_c;
        Box::new(Creeping { of: self.clone(), strain_k: 0.0, reference_c, hz_per_ug: setting.hz_per_ug() })
    }
}

/// Boltzmann's constant, eV/K.
const BOLTZMANN_EV_PER_K: f64 = 8.617_333e-5;
const ZERO_CELSIUS_K: f64 = 273.15;

struct Creeping {
    of: StressRelaxation,
    /// q: the part of all temperature changes that has not relaxed yet, K.
    strain_k: f64,
    reference_c: f64,
    hz_per_ug: f64,
}

impl Creeping {
    fn tau_s(&self, temperature_c: f64) -> f64 {
        if self.of.activation_energy_ev == 0.0 {
            return self.of.tau_s;
        }
        let inverse_k = (temperature_c + ZERO_CELSIUS_K).recip() - (self.reference_c + ZERO_CELSIUS_K).recip();
        self.of.tau_s * (self.of.activation_energy_ev / BOLTZMANN_EV_PER_K * inverse_k).exp()
    }
}

impl Effect for Creeping {
    fn advance(&mut self, now: &Conditions, dt_s: f64) {
        // Exact for a rate that is constant over the step.
        let tau_s = self.tau_s(now.sensor_c);
        let gone = -(-dt_s / tau_s).exp_m1();
        self.strain_k += (now.sensor_rate_c_per_s * tau_s - self.strain_k) * gone;
    }

    fn pull(&self, _now: &Conditions, forks: &mut Forks) {
        forks.shift_common(self.of.ug_per_k * self.strain_k * self.hz_per_ug, STRESS_MISMATCH);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn after_35_k_the_bias_creeps_back_in_100_minutes() {
        let mut alone = OneEffect::new(&StressRelaxation::default());
        alone.ramp(35.0, 1.0);
        assert!((alone.look().bias_ug - 175.0).abs() < 0.4, "{:?}", alone.look());
        alone.pass(6000.0);
        assert!((alone.look().bias_ug - 175.0 / std::f64::consts::E).abs() < 0.2);
    }

    #[test]
    fn in_the_cold_it_takes_longer() {
        let of = StressRelaxation { activation_energy_ev: 0.3, ..StressRelaxation::default() };
        let creeping = Creeping { of, strain_k: 0.0, reference_c: 25.0, hz_per_ug: 1.0 };
        // 0.3 eV: 25.9-fold at −40 °C, 0.293-fold at 60 °C.
        assert!((creeping.tau_s(-40.0) / 6000.0 - 25.9).abs() < 0.1, "{}", creeping.tau_s(-40.0));
        assert!((creeping.tau_s(60.0) / 6000.0 - 0.293).abs() < 0.001);
    }
}
