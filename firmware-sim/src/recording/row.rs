//! Runs and samples.

use crate::twin::noise_floor::NoiseFloor;

/// One uninterrupted recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedRun {
    /// Name of the run.
    pub name: String,
    /// Kind of the run, as the scenario names it.
    pub kind: String,
    /// The samples.
    pub rows: Vec<Row>,
}

/// One sample: what the instrument shows, what the rig states, and the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Time since the run began, s.
    pub time_s: f64,
    /// Time since the power came on, s.
    pub power_on_s: f64,
    /// Age of the device, days.
    pub age_days: f64,
    /// What the thermometer shows, °C.
    pub temperature_c: f64,
    /// Counted frequency of the first fork, Hz.
    pub f1_hz: f64,
    /// Counted frequency of the second fork, Hz.
    pub f2_hz: f64,
    /// f1 − f2, Hz.
    pub delta_f_hz: f64,
    /// f1 + f2, Hz.
    pub sum_f_hz: f64,
    /// Acceleration along the input axis that the rig states, g.
    pub reference_g: f64,
    /// Uncertainty that the rig states for it, g.
    pub reference_sigma_g: f64,
    /// Acceleration along the pendulous axis that the rig states, g.
    pub cross_g: f64,
    /// Supply voltage, V.
    pub supply_v: f64,
    /// Vibration, mean square, g².
    pub vibration_g2: f64,
    /// Air pressure, Pa.
    pub pressure_pa: f64,
    /// Relative humidity, percent.
    pub humidity_pct: f64,
    /// What nobody in the laboratory knows; never written out.
    pub truth: RowTruth,
}

/// The noiseless truth behind a row.
#[derive(Clone, Debug, PartialEq)]
pub struct RowTruth {
    /// What the input axis really saw, rig errors included, g.
    pub acceleration_g: f64,
    /// True temperature of the thermometer, °C.
    pub sensor_c: f64,
    /// True mean temperature of the forks, °C.
    pub resonator_c: f64,
    /// K1 of the effect-free device at the thermometer's temperature, Hz/g.
    pub scale_factor_hz_per_g: f64,
    /// Frequency of the first fork without noise and counter, effects included, Hz.
    pub f1_hz: f64,
    /// Frequency of the second fork without noise and counter, effects included, Hz.
    pub f2_hz: f64,
    /// The residual that a perfect static compensation would have here, by parts.
    pub floor: NoiseFloor,
}

impl RecordedRun {
    /// The residual of a perfect static compensation over this run, by parts. It grows with the run's length.
    #[must_use]
    pub fn noise_floor(&self) -> NoiseFloor {
        NoiseFloor::mean(self.rows.iter().map(|row| row.truth.floor))
    }
}

/// Rounds to the millionth that the instrument transmits and the table carries.
pub(crate) fn micro(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
