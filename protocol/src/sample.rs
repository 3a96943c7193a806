//! One instant as the instrument's counters saw it.

use crate::limits::MAX_CHANNELS;
use crate::reading::Status;
use serde::{Deserialize, Serialize};

/// Raw integers of one instant.
///
/// Frequencies are integers because they are differenced: at 41 kHz one `f32` step is about 4 mHz,
/// which is 47 µg. The pair is kept as difference and sum, which loses nothing
/// (`f1 = (sum + difference)/2`) and also fits instruments that report the difference alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sample {
    /// Instrument clock, µs.
    pub time_us: u64,
    /// Time since power was applied, µs.
    pub power_on_us: u64,
    /// Calendar age of the sensor, s; `None` where nobody knows the date.
    pub age_s: Option<u32>,
    /// f1 − f2, µHz.
    pub delta_f_uhz: i64,
    /// f1 + f2, µHz; `None` where only the difference was measured.
    pub sum_f_uhz: Option<u64>,
    /// Thermometer, µ°C.
    pub temperature_uc: i32,
    /// Auxiliary channels in millionths of their unit, in the order that the calibration names them;
    /// [`Sample::NOT_MEASURED`] where nobody measured.
    pub channels: [i64; MAX_CHANNELS],
    /// What the drivers had to say of this instant.
    pub faults: Status,
}

impl Sample {
    /// The value of a channel that nobody measured: no channel can have it, and zero would be a value.
    pub const NOT_MEASURED: i64 = i64::MIN;

    /// A sample of the two resonators' frequencies. Power was applied when the clock stood at zero, the age is unknown,
    /// and no auxiliary channel was measured: whoever measures one writes it into [`Sample::channels`].
    #[must_use]
    pub const fn from_pair(time_us: u64, f1_uhz: u64, f2_uhz: u64, temperature_uc: i32) -> Self {
        let delta_f_uhz = f1_uhz.wrapping_sub(f2_uhz).cast_signed();
        Self {
            sum_f_uhz: Some(f1_uhz.saturating_add(f2_uhz)),
            ..Self::from_difference(time_us, delta_f_uhz, temperature_uc)
        }
    }

    /// A sample of the frequency difference alone, everything else as [`Sample::from_pair`] leaves it.
    #[must_use]
    pub const fn from_difference(time_us: u64, delta_f_uhz: i64, temperature_uc: i32) -> Self {
        Self {
            time_us,
            power_on_us: time_us,
            age_s: None,
            delta_f_uhz,
            sum_f_uhz: None,
            temperature_uc,
            channels: [Self::NOT_MEASURED; MAX_CHANNELS],
            faults: Status::empty(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_measured_until_somebody_says_so() {
        let pair = Sample::from_pair(7, 3, 2, 1);
        assert_eq!((pair.channels, pair.age_s), ([Sample::NOT_MEASURED; MAX_CHANNELS], None));
        let difference = Sample::from_difference(7, 1, 1);
        assert_eq!((difference.channels, difference.sum_f_uhz), ([Sample::NOT_MEASURED; MAX_CHANNELS], None));
    }

    #[test]
    fn a_pair_is_kept_without_loss() {
        for (f1, f2) in [(41_238_000_001, 41_162_000_000), (41_162_000_000, 41_238_000_007), (0, 0)] {
            let sample = Sample::from_pair(0, f1, f2, 0);
            let sum = sample.sum_f_uhz.expect("a pair has a sum").cast_signed();
            assert_eq!((sum + sample.delta_f_uhz) / 2, f1.cast_signed());
            assert_eq!((sum - sample.delta_f_uhz) / 2, f2.cast_signed());
        }
    }
}
