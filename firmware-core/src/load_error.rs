//! Why a calibration is refused.

use crate::program::ProgramError;
use core::fmt;

/// Why a calibration can't be run, although its bytes are sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum LoadError {
    /// This firmware doesn't know the effect.
    UnknownEffect(u16),
    /// The effect takes another number of coefficients.
    Coefficients {
        /// The effect's number.
        effect: u16,
        /// Coefficients in the blob.
        found: usize,
        /// Coefficients that it takes.
        expected: usize,
    },
    /// The effect uses a channel that the blob doesn't name.
    Channel {
        /// The effect's number.
        effect: u16,
    },
    /// The effect's program can't be run.
    Program {
        /// The effect's number.
        effect: u16,
        /// Why.
        why: ProgramError,
    },
    /// More effects than the instrument has room for.
    TooManyEffects,
    /// A weight, coefficient or scale is infinite or not a number, or an input gain is not positive.
    Number,
    /// The calibrated domain is empty.
    Domain,
    /// The slope of the static model vanishes or turns its sign within the calibrated domain.
    Slope {
        /// Frequency difference where it was found, µHz.
        delta_f_uhz: i64,
        /// Temperature where it was found, µ°C.
        temperature_uc: i32,
    },
    /// This processor computes other bits than the one that made the calibration.
    Proof {
        /// The checksum of the bits computed here.
        computed: u32,
        /// The checksum that the blob carries.
        stored: u32,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownEffect(id) => write!(f, "effect number {id} is unknown to this firmware"),
            Self::Coefficients { effect, found, expected } => {
                write!(f, "effect number {effect} takes {expected} coefficients, the blob has {found}")
            }
            Self::Channel { effect } => write!(f, "effect number {effect} uses a channel that the blob doesn't name"),
            Self::Program { effect, why } => write!(f, "the program of effect number {effect} can't be run: {why}"),
            Self::TooManyEffects => write!(f, "more effects than the instrument has room for"),
            Self::Number => write!(f, "a weight, coefficient or scale is not a usable number"),
            Self::Domain => write!(f, "the calibrated domain is empty"),
            // Integers only: printing a float costs a device kilobytes.
            Self::Slope { delta_f_uhz, temperature_uc } => write!(
                f,
                "the slope of the static model vanishes or turns its sign within the calibrated domain, near a signal of {} and {} °C: it can't measure there",
                delta_f_uhz / 1_000_000,
                temperature_uc / 1_000_000
            ),
            Self::Proof { computed, stored } => write!(
                f,
                "this processor computes other bits ({computed:#010x}) than the one that made the calibration ({stored:#010x})"
            ),
        }
    }
}

impl core::error::Error for LoadError {}
