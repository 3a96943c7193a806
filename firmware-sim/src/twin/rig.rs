//! The laboratory: room, chamber, dividing head, and their errors.

use serde::{Deserialize, Serialize};

use crate::limit::{Fault, positive, within};

/// The test rig. Its errors are off by default: the reference is then exact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rig {
    /// Temperature of the room, where every run begins and the device rests, °C.
    pub room_c: f64,
    /// Time constant of the chamber's air behind its set point, s.
    pub chamber_tau_s: f64,
    /// Time between runs that state no age, with the power off, h.
    pub pause_h: f64,
    /// Air pressure when no run changes it, Pa.
    pub pressure_pa: f64,
    /// Relative humidity when no run changes it, percent.
    pub humidity_pct: f64,
    /// Random error of the dividing head, drawn anew for every pose, arc seconds (1σ). 1″ is 4.85 µg at 0 g.
    pub table_arcsec: f64,
    /// Tilt of the mounting, drawn anew for every run, arc seconds (1σ).
    pub mount_arcsec: f64,
    /// Error of the dividing head's zero, the same in every run, arc seconds.
    pub table_zero_arcsec: f64,
    /// Bias that differs from soaked node to soaked node, µg (1σ).
    pub node_scatter_ug: f64,
}

impl Default for Rig {
    fn default() -> Self {
        Self {
            room_c: 25.0,
            chamber_tau_s: 500.0,
            pause_h: 12.0,
            pressure_pa: 101_325.0,
            humidity_pct: 40.0,
            table_arcsec: 0.0,
            mount_arcsec: 0.0,
            table_zero_arcsec: 0.0,
            node_scatter_ug: 0.0,
        }
    }
}

/// One arc second in radians.
pub(crate) const ARCSEC: f64 = std::f64::consts::PI / 648_000.0;

impl Rig {
    /// The same laboratory with a perfect reference.
    #[must_use]
    pub fn without_errors(&self) -> Self {
        Self { table_arcsec: 0.0, mount_arcsec: 0.0, table_zero_arcsec: 0.0, node_scatter_ug: 0.0, ..self.clone() }
    }

    /// The uncertainty of the reference that the rig would state for a pose, g.
    #[must_use]
    pub fn reference_sigma_g(&self, tilt_g_per_rad: f64) -> f64 {
        let angle_arcsec = self.table_arcsec.hypot(self.mount_arcsec).hypot(self.table_zero_arcsec);
        angle_arcsec * ARCSEC * tilt_g_per_rad.abs()
    }

    /// # Errors
    /// The first number that no laboratory has.
    pub fn check(&self) -> Result<(), Fault> {
        within("room_c", self.room_c, -20.0, 60.0)?;
        positive("chamber_tau_s", self.chamber_tau_s)?;
        within("pause_h", self.pause_h, 0.0, 1e5)?;
        within("pressure_pa", self.pressure_pa, 0.0, 1e6)?;
        within("humidity_pct", self.humidity_pct, 0.0, 100.0)?;
        within("table_arcsec", self.table_arcsec, 0.0, 3600.0)?;
        within("mount_arcsec", self.mount_arcsec, 0.0, 3600.0)?;
        within("table_zero_arcsec", self.table_zero_arcsec, -3600.0, 3600.0)?;
        within("node_scatter_ug", self.node_scatter_ug, 0.0, 1e5)
    }
}
