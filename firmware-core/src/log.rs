//! What the instrument says of itself to whoever debugs it. Without the feature `defmt` every function here is empty.
//!
//! Each is called where something happens for the first time, never once a reading: a log that floods tells nothing.
#![cfg_attr(not(feature = "defmt"), allow(unused_variables, clippy::missing_const_for_fn))]

use crate::load_error::LoadError;
use protocol::{BlobError, Status};

/// Power was applied; the program runs.
pub fn power_on() {
    #[cfg(feature = "defmt")]
    defmt::info!("power on");
}

/// A calibration passed every check and is in use from now on.
pub(crate) fn in_use(provenance: [u8; 8]) {
    #[cfg(feature = "defmt")]
    defmt::info!("calibration {=[u8; 8]:02x} in use", provenance);
}

/// The instrument measures uncalibrated.
pub(crate) fn none_stored() {
    #[cfg(feature = "defmt")]
    defmt::warn!("no stored calibration can be used");
}

/// Bytes that should have been a calibration are none.
pub(crate) fn no_calibration(why: &BlobError) {
    #[cfg(feature = "defmt")]
    defmt::warn!("no calibration: {}", why);
}

/// A calibration is sound and can't be run here.
pub(crate) fn unusable(why: &LoadError) {
    #[cfg(feature = "defmt")]
    defmt::warn!("calibration refused: {}", why);
}

/// A calibration belongs to another sensor.
pub(crate) fn foreign() {
    #[cfg(feature = "defmt")]
    defmt::warn!("calibration refused: it belongs to another sensor");
}

/// Flags that no reading since power-on has had before.
pub(crate) fn raised(status: Status) {
    #[cfg(feature = "defmt")]
    for (name, _) in status.iter_names() {
        defmt::warn!("raised for the first time: {=str}", name);
    }
}
