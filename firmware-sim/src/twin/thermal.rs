//! The thermal network: chamber air, package, and the warmth of the powered package itself.
//!
//! Apart from the effects because thermometer and forks share it: whatever it does, a static map still holds. Only an
//! effect separates the two.

use crate::twin::lag::{follow, relax};
use crate::twin::rig::Rig;
use crate::twin::truth::Truth;

/// Temperatures that follow the chamber's set point.
#[derive(Clone, Debug)]
pub(crate) struct Thermal {
    chamber_tau_s: f64,
    sensor_tau_s: f64,
    self_heating_k: f64,
    self_heating_tau_s: f64,
    chamber_c: f64,
    package_c: f64,
    heating_k: f64,
}

impl Thermal {
    /// In equilibrium with the room, unpowered.
    pub(crate) fn new(truth: &Truth, rig: &Rig) -> Self {
        Self {
            chamber_tau_s: rig.chamber_tau_s,
            sensor_tau_s: truth.sensor_tau_s,
            self_heating_k: truth.self_heating_k,
            self_heating_tau_s: truth.self_heating_tau_s,
            chamber_c: rig.room_c,
            package_c: rig.room_c,
            heating_k: 0.0,
        }
    }

    /// Replaces the warmth of the powered package, K and s, for the runs that state their own.
    pub(crate) fn set_self_heating(&mut self, self_heating_k: f64, self_heating_tau_s: f64) {
        self.self_heating_k = self_heating_k;
        self.self_heating_tau_s = self_heating_tau_s;
    }

    /// True temperature of the thermometer, °C.
    pub(crate) fn sensor_c(&self) -> f64 {
        self.package_c + self.heating_k
    }

    /// One step towards a set point that stands still during the step.
    pub(crate) fn advance(&mut self, setpoint_c: f64, powered: bool, dt_s: f64) {
        let before_c = self.chamber_c;
        self.chamber_c = relax(before_c, setpoint_c, dt_s, self.chamber_tau_s);
        self.package_c = follow(self.package_c, before_c, self.chamber_c, dt_s, self.sensor_tau_s);
        let full_k = if powered { self.self_heating_k } else { 0.0 };
        self.heating_k = relax(self.heating_k, full_k, dt_s, self.self_heating_tau_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unheated() -> Thermal {
        Thermal::new(&Truth { self_heating_k: 0.0, ..Truth::b() }, &Rig::default())
    }

    #[test]
    fn after_an_hour_the_package_is_15_mk_from_a_node_20_k_away() {
        let mut thermal = unheated();
        (0..3600).for_each(|_| thermal.advance(45.0, true, 1.0));
        let missing_k = 45.0 - thermal.sensor_c();
        // 20 K·exp(−3600/500), one per cent more for the package behind the chamber.
        assert!((missing_k - 0.0151).abs() < 0.0002, "{missing_k}");
    }

    #[test]
    fn the_powered_package_warms_up_and_cools_down() {
        let mut thermal = Thermal::new(&Truth::b(), &Rig::default());
        (0..900).for_each(|_| thermal.advance(25.0, true, 1.0));
        assert!((thermal.sensor_c() - 25.0 - 0.3 * (1.0 - (-1.0_f64).exp())).abs() < 1e-9);
        (0..9000).for_each(|_| thermal.advance(25.0, false, 1.0));
        assert!(thermal.sensor_c() - 25.0 < 1e-4);
    }
}
