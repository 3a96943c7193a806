//! What the instrument answers: an acceleration that says how far it can be trusted.

use bitflags::bitflags;
use serde::{Deserialize, Serialize};

bitflags! {
    /// Everything that stands between a reading and full trust. Empty means calibrated and within the calibrated domain.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
    pub struct Status: u16 {
        /// No valid calibration is loaded: the acceleration is not a number.
        const UNCALIBRATED = 1 << 0;
        /// The temperature lies outside the calibrated domain: the reading is extrapolated.
        const TEMPERATURE_OUTSIDE = 1 << 1;
        /// The frequency difference lies outside the calibrated domain: the reading is extrapolated.
        const FREQUENCY_OUTSIDE = 1 << 2;
        /// The previous sample is older than the calibration allows: memories (lags, hysteresis) started anew.
        const STALE = 1 << 3;
        /// Time did not advance since the previous sample: memories kept their state.
        const TIME_REVERSED = 1 << 4;
        /// The thermometer did not answer or its value is impossible: the acceleration is not a number.
        const THERMOMETER_FAULT = 1 << 5;
        /// A resonator stands still or its counter overflowed: the acceleration is not a number.
        const RESONATOR_FAULT = 1 << 6;
        /// A channel or a date that the calibration needs was not measured: its effect is left out.
        const CHANNEL_MISSING = 1 << 7;
        /// A memory has not yet seen enough of the past to be trusted.
        const SETTLING = 1 << 8;
    }
}

impl Status {
    /// Faults that leave no number to report.
    pub const FATAL: Self = Self::UNCALIBRATED.union(Self::THERMOMETER_FAULT).union(Self::RESONATOR_FAULT);
}

/// One compensated output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// The sample's time, µs.
    pub time_us: u64,
    /// Acceleration along the input axis, g; the canonical NaN where [`Status::FATAL`] intersects the status.
    pub acceleration_g: f32,
    /// How far the number can be trusted.
    pub status: Status,
}

impl Reading {
    /// The one NaN of the product. Processors disagree on the bits of a NaN that arithmetic makes.
    pub const NO_NUMBER: f32 = f32::from_bits(0x7FC0_0000);

    /// The reading of a sample that yields no number, with the reason in `status`.
    #[must_use]
    pub const fn none(time_us: u64, status: Status) -> Self {
        Self { time_us, acceleration_g: Self::NO_NUMBER, status }
    }

    /// Whether both readings are the same, bit for bit.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        self.time_us == other.time_us
            && self.status == other.status
            && self.acceleration_g.to_bits() == other.acceleration_g.to_bits()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_differ_in_any_field_and_a_nan_is_like_itself() {
        let reading = Reading { time_us: 1, acceleration_g: 0.5, status: Status::STALE };
        assert!(reading.same_bits(&reading));
        assert!(!reading.same_bits(&Reading { time_us: 2, ..reading }));
        assert!(!reading.same_bits(&Reading { acceleration_g: 0.500_000_06, ..reading }));
        assert!(!reading.same_bits(&Reading { status: Status::empty(), ..reading }));
        let none = Reading::none(1, Status::STALE);
        assert!(none.same_bits(&none) && !none.same_bits(&reading));
        let zero = Reading { acceleration_g: 0.0, ..reading };
        assert!(!zero.same_bits(&Reading { acceleration_g: -0.0, ..reading }));
    }
}
