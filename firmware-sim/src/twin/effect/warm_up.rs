//! `warm-up`: what settles after power-on and the thermometer does not see.
//!
//! ```text
//! ΔB  = A·e^(−t_on/τ)                          the electronics settle
//! ΔT  = ΔT∞·h,   τ_h·dh/dt = (1 if on else 0) − h    the forks heat themselves
//! ```
//!
//! The first part acts as an acceleration and begins anew with every power-on. The second, off by default, acts on
//! the temperature of the forks and remembers a short power-off. Typical: 140 µg and 600 s, solved from the
//! compensated Table 1 of Micromachines 2022, 13(7), 1054; 0.05–1 K and 300–1800 s. IEEE Std 528, turn-on transient;
//! Tocchio et al., oscillator start-up of resonant accelerometers.

use serde::{Deserialize, Serialize};

use super::{Effect, Setting, Switch};
use crate::limit::{Fault, positive, within};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::lag::relax;
use crate::twin::random::Random;

/// Parameters of `warm-up`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WarmUp {
    /// A: bias at the moment of power-on, µg.
    pub bias_ug: f64,
    /// τ: time constant of the electronics, s.
    pub tau_s: f64,
    /// ΔT∞: temperature rise of the forks above the thermometer, K.
    pub self_heating_k: f64,
    /// τ_h: time constant of that rise, s.
    pub self_heating_tau_s: f64,
}

impl Default for WarmUp {
    fn default() -> Self {
        Self { bias_ug: 140.0, tau_s: 600.0, self_heating_k: 0.0, self_heating_tau_s: 900.0 }
    }
}

impl Switch for WarmUp {
    const NAME: &'static str = "warm-up";

    fn check(&self) -> Result<(), Fault> {
        within("bias_ug", self.bias_ug, -1e5, 1e5)?;
        positive("tau_s", self.tau_s)?;
        within("self_heating_k", self.self_heating_k, -50.0, 50.0)?;
        positive("self_heating_tau_s", self.self_heating_tau_s)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self { bias_ug: self.bias_ug * factor, self_heating_k: self.self_heating_k * factor, ..self.clone() }
    }

    fn varied(&self, random: &mut Random) -> Self {
        Self { tau_s: random.log_between(200.0, 1800.0), ..self.scaled(random.sign()) }
    }

    fn start(&self, _setting: &Setting) -> Box<dyn Effect> {
        Box::new(Warming { of: self.clone(), heat: 0.0 })
    }
}

struct Warming {
    of: WarmUp,
    heat: f64,
}

impl Effect for Warming {
    fn advance(&mut self, now: &Conditions, dt_s: f64) {
        let full = if now.power_on_s.is_some() { 1.0 } else { 0.0 };
        self.heat = relax(self.heat, full, dt_s, self.of.self_heating_tau_s);
    }

    fn act(&self, now: &Conditions, input: &mut Input) {
        let settling = now.power_on_s.map_or(0.0, |on_s| (-on_s / self.of.tau_s).exp());
        input.acceleration_g += self.of.bias_ug * 1e-6 * settling;
        input.temperature_c += self.of.self_heating_k * self.heat;
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn the_electronics_settle_in_ten_minutes_and_begin_anew() {
        let mut alone = OneEffect::new(&WarmUp::default());
        assert!((alone.look().bias_ug - 140.0).abs() < 1e-3);
        alone.pass(600.0);
        assert!((alone.look().bias_ug - 140.0 / std::f64::consts::E).abs() < 1e-3);
        alone.now.power_on_s = Some(0.0);
        assert!((alone.look().bias_ug - 140.0).abs() < 1e-3);
    }

    #[test]
    fn the_forks_stay_warm_through_a_short_power_off() {
        let of = WarmUp { bias_ug: 0.0, self_heating_k: 0.2, ..WarmUp::default() };
        let mut alone = OneEffect::new(&of);
        alone.pass(9000.0);
        assert!((alone.look().mean_hz + 0.2 * 2.406).abs() < 0.001, "{:?}", alone.look());
        alone.now.power_on_s = None;
        alone.pass(900.0);
        assert!((alone.look().mean_hz + 0.2 * 2.406 / std::f64::consts::E).abs() < 0.001);
    }
}
