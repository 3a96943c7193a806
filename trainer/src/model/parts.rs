//! The parts of a model file.

use super::arrays::{exactly, rows_exactly};
use protocol::limits::HIDDEN;
use protocol::{Domain, Scaling};
use serde::{Deserialize, Serialize};

/// Units of the measured quantities.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Of the signal, usually Hz.
    pub signal: String,
    /// Of the reference, usually g.
    pub reference: String,
}

/// See [`Scaling`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelScaling {
    /// Frequency difference at x = 0, µHz.
    pub delta_f_zero_uhz: i64,
    /// x per Hz.
    pub delta_f_gain_per_hz: f32,
    /// Temperature at t = 0, µ°C.
    pub temperature_zero_uc: i32,
    /// t per °C.
    pub temperature_gain_per_c: f32,
    /// Constant, x, t, x·t of the first-order instrument, g.
    #[serde(deserialize_with = "exactly")]
    pub line_g: [f32; 4],
    /// g per unit of network output.
    pub output_g: f32,
}

/// See [`Domain`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelDomain {
    /// Lowest and highest frequency difference, µHz.
    #[serde(deserialize_with = "exactly")]
    pub delta_f_uhz: [i64; 2],
    /// Lowest and highest temperature, µ°C.
    #[serde(deserialize_with = "exactly")]
    pub temperature_uc: [i32; 2],
    /// Longest gap between samples across which memories are carried, µs; [`u32::MAX`] means any.
    pub max_gap_us: u32,
}

/// The network's weights by unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelNetwork {
    /// [x, t] weights of each hidden unit.
    #[serde(deserialize_with = "rows_exactly")]
    pub input: [[f32; 2]; HIDDEN],
    /// Threshold of each hidden unit.
    #[serde(deserialize_with = "exactly")]
    pub bias: [f32; HIDDEN],
    /// Output weight of each hidden unit.
    #[serde(deserialize_with = "exactly")]
    pub output: [f32; HIDDEN],
    /// Threshold of the output.
    pub output_bias: f32,
}

impl ModelScaling {
    /// The form that the core takes.
    #[must_use]
    pub const fn to_wire(self) -> Scaling {
        Scaling {
            delta_f_zero_uhz: self.delta_f_zero_uhz,
            delta_f_gain_per_hz: self.delta_f_gain_per_hz,
            temperature_zero_uc: self.temperature_zero_uc,
            temperature_gain_per_c: self.temperature_gain_per_c,
            line_g: self.line_g,
            output_g: self.output_g,
        }
    }
}

impl ModelDomain {
    pub(super) const fn to_wire(self) -> Domain {
        let ([f_low, f_high], [t_low, t_high]) = (self.delta_f_uhz, self.temperature_uc);
        Domain { delta_f_uhz: (f_low, f_high), temperature_uc: (t_low, t_high) }
    }
}
