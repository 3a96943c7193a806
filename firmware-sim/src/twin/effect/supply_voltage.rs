//! `supply-voltage`: drive and bias voltage follow the rail.
//!
//! ```text
//! ΔB = K_V·v + K_V2·v²        ΔK1/K1 = k_V·v        v = (V − V0)/V0
//! ```
//!
//! The electrostatic spring and the drive amplitude shift both forks together; a tenth of it shows in the difference.
//! Typical: 1–100 µg/%, 1–50 ppm/%. Comi et al., JMEMS 2010; Bahl et al., JMEMS 2011.

use serde::{Deserialize, Serialize};

use super::{DRIVE_MISMATCH, Effect, Setting, Switch};
use crate::limit::{Fault, within};
use crate::twin::conditions::{Conditions, Forks, Input};
use crate::twin::random::Random;

/// Parameters of `supply-voltage`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SupplyVoltage {
    /// K_V: bias per percent of supply, µg/%.
    pub ug_per_pct: f64,
    /// K_V2: curvature, µg/%².
    pub ug_per_pct2: f64,
    /// k_V: scale factor per percent of supply, ppm/%.
    pub scale_factor_ppm_per_pct: f64,
}

impl Default for SupplyVoltage {
    fn default() -> Self {
        Self { ug_per_pct: 50.0, ug_per_pct2: 0.0, scale_factor_ppm_per_pct: 0.0 }
    }
}

impl Switch for SupplyVoltage {
    const NAME: &'static str = "supply-voltage";

    fn check(&self) -> Result<(), Fault> {
        within("ug_per_pct", self.ug_per_pct, -1e5, 1e5)?;
        within("ug_per_pct2", self.ug_per_pct2, -1e5, 1e5)?;
        within("scale_factor_ppm_per_pct", self.scale_factor_ppm_per_pct, -1e4, 1e4)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            ug_per_pct: self.ug_per_pct * factor,
            ug_per_pct2: self.ug_per_pct2 * factor,
            scale_factor_ppm_per_pct: self.scale_factor_ppm_per_pct * factor,
        }
    }

    fn varied(&self, random: &mut Random) -> Self {
        self.scaled(random.sign())
    }

    fn start(&self, setting: &Setting) -> Box<dyn Effect> {
        let nominal_v = setting.truth.supply_v;
        Box::new(Supplied { of: self.clone(), nominal_v, hz_per_ug: setting.hz_per_ug() })
    }
}

struct Supplied {
    of: SupplyVoltage,
    nominal_v: f64,
    hz_per_ug: f64,
}

impl Supplied {
    fn off_pct(&self, now: &Conditions) -> f64 {
        (now.supply_v - self.nominal_v) / self.nominal_v * 100.0
    }
}

impl Effect for Supplied {
    fn act(&self, now: &Conditions, input: &mut Input) {
        input.scale += self.of.scale_factor_ppm_per_pct * 1e-6 * self.off_pct(now);
    }

    fn pull(&self, now: &Conditions, forks: &mut Forks) {
        let off_pct = self.off_pct(now);
        let bias_ug = (self.of.ug_per_pct + self.of.ug_per_pct2 * off_pct) * off_pct;
        forks.shift_common(bias_ug * self.hz_per_ug, DRIVE_MISMATCH);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_effect::OneEffect;
    use super::*;

    #[test]
    fn five_percent_more_is_250_micro_g_and_ten_times_that_in_the_mean() {
        let mut alone = OneEffect::new(&SupplyVoltage::default());
        alone.now.supply_v = 5.25;
        let seen = alone.look();
        assert!((seen.bias_ug - 250.0).abs() < 1e-3, "{seen:?}");
        assert!((seen.mean_hz - 10.0 * 250e-6 * 83.5005).abs() < 1e-4, "{seen:?}");
    }
}
