//! What the simulated accelerometer is: every parameter of the device, in the units of its data sheet.
//!
//! Apart from the equations so that a laboratory can write another device down without reading code.

use serde::{Deserialize, Serialize};

use crate::limit::{Fault, positive, within};

/// All parameters of the device, without any switchable effect.
///
/// Two double-ended tuning forks hang on one proof mass, one pulled and one pushed by acceleration: `f_i = f_i0·√(1 +
/// e1θ + e2θ² + h1_iθ + h2_iθ² ± s_i·a)` with `θ = T − 25 °C`. `e` is silicon's Young modulus (Jaakkola et al., arXiv
/// 1401.1363), `h` the axial stress from the package (Huang et al., Sensors & Transducers 2013). The default
/// reproduces the device of Huang, Jiang, Zhao, Ding, Micromachines 2022, 13(7), 1054, test data set 2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Truth {
    /// Frequency of the fork that acceleration pulls, at 0 g and the reference temperature, Hz.
    pub f1_hz: f64,
    /// Frequency of the fork that acceleration pushes, at 0 g and the reference temperature, Hz.
    pub f2_hz: f64,
    /// Temperature at which the frequencies are stated, °C.
    pub reference_temperature_c: f64,
    /// Mean temperature coefficient of frequency of the two forks, ppm/K.
    pub tcf_ppm_per_k: f64,
    /// Difference of the forks' temperature coefficients, first minus second, ppm/K. It makes the bias drift.
    pub tcf_difference_ppm_per_k: f64,
    /// e1: first temperature coefficient of Young's modulus, acting on f², ppm/K.
    pub young_linear_ppm_per_k: f64,
    /// e2: second temperature coefficient of Young's modulus, acting on f², ppb/K².
    pub young_quadratic_ppb_per_k2: f64,
    /// Mean of h2, the second-order package stress, acting on f², ppb/K².
    pub stress_quadratic_ppb_per_k2: f64,
    /// Difference of the forks' h2, first minus second, ppb/K². It bends the bias.
    pub stress_quadratic_difference_ppb_per_k2: f64,
    /// Differential scale factor K1 for equal mean frequencies, Hz/g.
    pub scale_factor_hz_per_g: f64,
    /// Relative difference of the forks' force sensitivities, percent. It makes the native K2.
    pub scale_factor_mismatch_pct: f64,
    /// Quality factor of the forks.
    pub quality_factor: f64,
    /// Time constant of the package behind the chamber's air, s. Thermometer and forks share the package.
    pub sensor_tau_s: f64,
    /// Temperature rise of the powered package, seen by thermometer and forks alike, K.
    pub self_heating_k: f64,
    /// Time constant of that rise, s.
    pub self_heating_tau_s: f64,
    /// Nominal supply voltage, V.
    pub supply_v: f64,
}

impl Default for Truth {
    fn default() -> Self {
        Self {
            f1_hz: 41_238.0,
            f2_hz: 41_162.0,
            reference_temperature_c: 25.0,
            tcf_ppm_per_k: -58.4,
            tcf_difference_ppm_per_k: 1.957,
            young_linear_ppm_per_k: -60.0,
            young_quadratic_ppb_per_k2: -50.0,
            stress_quadratic_ppb_per_k2: 0.0,
            stress_quadratic_difference_ppb_per_k2: -2.4,
            scale_factor_hz_per_g: 83.5,
            scale_factor_mismatch_pct: 1.2,
            quality_factor: 2e4,
            sensor_tau_s: 5.0,
            self_heating_k: 0.3,
            self_heating_tau_s: 900.0,
            supply_v: 5.0,
        }
    }
}

impl Truth {
    /// Configuration A1: the stress-dominated device whose scale factor varies ten times as much, the smooth reading of
    /// the paper's test data set 1.
    #[must_use]
    pub fn a1() -> Self {
        Self { tcf_ppm_per_k: -559.8, tcf_difference_ppm_per_k: 4.147, ..Self::default() }
    }

    /// Configuration B, the default: the paper's test data set 2. Configuration A2 is this device with one bad state,
    /// which is the run's and not the device's: see [`crate::scenario::BadState`].
    #[must_use]
    pub fn b() -> Self {
        Self::default()
    }

    /// # Errors
    /// The first parameter that no such device can have.
    pub fn check(&self) -> Result<(), Fault> {
        within("f1_hz", self.f1_hz, 1e3, 1e7)?;
        within("f2_hz", self.f2_hz, 1e3, 1e7)?;
        within("reference_temperature_c", self.reference_temperature_c, -100.0, 200.0)?;
        within("tcf_ppm_per_k", self.tcf_ppm_per_k, -2e3, 2e3)?;
        within("tcf_difference_ppm_per_k", self.tcf_difference_ppm_per_k, -500.0, 500.0)?;
        within("young_linear_ppm_per_k", self.young_linear_ppm_per_k, -500.0, 500.0)?;
        within("young_quadratic_ppb_per_k2", self.young_quadratic_ppb_per_k2, -2e3, 2e3)?;
        within("stress_quadratic_ppb_per_k2", self.stress_quadratic_ppb_per_k2, -2e3, 2e3)?;
        within("stress_quadratic_difference_ppb_per_k2", self.stress_quadratic_difference_ppb_per_k2, -2e3, 2e3)?;
        within("scale_factor_hz_per_g", self.scale_factor_hz_per_g, 0.1, 1e4)?;
        within("scale_factor_mismatch_pct", self.scale_factor_mismatch_pct, -50.0, 50.0)?;
        positive("quality_factor", self.quality_factor)?;
        positive("sensor_tau_s", self.sensor_tau_s)?;
        within("self_heating_k", self.self_heating_k, 0.0, 50.0)?;
        positive("self_heating_tau_s", self.self_heating_tau_s)?;
        within("supply_v", self.supply_v, 0.5, 100.0)
    }
}
