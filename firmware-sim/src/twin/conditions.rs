//! What surrounds the device at one instant, and the two places where an effect may act.
//!
//! Apart from the effects so that they know the laboratory and the signal path, and not each other.

use crate::twin::position::Position;
use crate::twin::static_map::StaticMap;

/// Seconds in a day.
pub const DAY_S: f64 = 86_400.0;

/// Everything that is true around the device at the end of one step.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Time since the run began, s.
    pub time_s: f64,
    /// Time since the device was built, days.
    pub age_days: f64,
    /// Time since the power came on, s; `None` while it is off.
    pub power_on_s: Option<f64>,
    /// True temperature of the thermometer and the package around it, °C.
    pub sensor_c: f64,
    /// The same at the beginning of the step, °C.
    pub sensor_before_c: f64,
    /// Its rate of change over the step, K/s.
    pub sensor_rate_c_per_s: f64,
    /// Orientation, and what the rig believes it applies.
    pub position: Position,
    /// What the input axis really sees: with the rig's own errors, without the device's effects, g.
    pub applied_g: f64,
    /// Counts the poses since the run began: it changes whenever the rig moves.
    pub pose: usize,
    /// Supply voltage, V.
    pub supply_v: f64,
    /// Vibration of the rig, mean square, g².
    pub vibration_g2: f64,
    /// Air pressure on the package, Pa.
    pub pressure_pa: f64,
    /// Relative humidity, percent.
    pub humidity_pct: f64,
}

/// What reaches the forks: the first place where effects act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Acceleration along the input axis, with everything that acts like one, g.
    pub acceleration_g: f64,
    /// Force sensitivity relative to nominal.
    pub scale: f64,
    /// Mean temperature of the forks, °C.
    pub temperature_c: f64,
    /// Temperature of the first fork minus that of the second, K.
    pub gradient_k: f64,
}

impl Input {
    /// Before any effect: the applied acceleration, and forks as warm as the thermometer.
    #[must_use]
    pub fn undisturbed(now: &Conditions) -> Self {
        Self { acceleration_g: now.applied_g, scale: 1.0, temperature_c: now.sensor_c, gradient_k: 0.0 }
    }

    /// The frequencies that this input gives the forks.
    #[must_use]
    pub fn forks(&self, map: &StaticMap) -> Forks {
        let temperatures_c = [self.temperature_c + self.gradient_k / 2.0, self.temperature_c - self.gradient_k / 2.0];
        let [f1_hz, f2_hz] = map.forks_apart_hz(self.acceleration_g, temperatures_c, self.scale);
        Forks { f1_hz, f2_hz }
    }
}

/// The oscillating forks: the second place where effects act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forks {
    /// Frequency of the fork that acceleration pulls, Hz.
    pub f1_hz: f64,
    /// Frequency of the fork that acceleration pushes, Hz.
    pub f2_hz: f64,
}

impl Forks {
    /// f1 − f2, Hz.
    #[must_use]
    pub fn delta_hz(&self) -> f64 {
        self.f1_hz - self.f2_hz
    }

    /// Moves both forks together by so much that their mismatch, a fraction of the common shift, moves the difference
    /// by `delta_hz`. This is what package stress, drive amplitude and charge do.
    pub fn shift_common(&mut self, delta_hz: f64, mismatch: f64) {
        let common_hz = delta_hz / mismatch;
        self.f1_hz += common_hz + delta_hz / 2.0;
        self.f2_hz += common_hz - delta_hz / 2.0;
    }

    /// Moves the forks apart by `delta_hz`; their mean stays.
    pub fn shift_apart(&mut self, delta_hz: f64) {
        self.f1_hz += delta_hz / 2.0;
        self.f2_hz -= delta_hz / 2.0;
    }
}
