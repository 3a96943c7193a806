//! The effects that can be switched on: one file each, one list of them here.
//!
//! An effect acts in one of two places, which is what tells effects apart when both frequencies are recorded: on what
//! reaches the forks ([`Effect::act`]), or on the oscillating forks themselves ([`Effect::pull`]). The list is in the
//! order of the signal path.

use serde::{Deserialize, Serialize};

use crate::limit::Fault;
use crate::twin::random::Random;

mod switch;

use switch::{DRIVE_MISMATCH, STRESS_MISMATCH};
pub use switch::{Effect, Setting, Switch};

/// Declares every effect once: name in the file, module, field, and parameters.
macro_rules! effects {
    ($($name:literal $module:ident $parameters:ident;)*) => {
        $(mod $module; pub use $module::$parameters;)*

        /// The effects that are switched on. An empty `[effects.NAME]` takes the literature's typical size.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Effects {
            $(
                #[doc = concat!("`[effects.", $name, "]`")]
                #[serde(rename = $name, default, skip_serializing_if = "Option::is_none")]
                pub $module: Option<$parameters>,
            )*
        }

        impl Effects {
            /// The names of all effects, in the order of the signal path.
            pub const NAMES: &[&str] = &[$($name),*];

            /// The names of the effects that are switched on.
            #[must_use]
            pub fn active(&self) -> Vec<&'static str> {
                let mut names = Vec::new();
                $(if self.$module.is_some() { names.push($parameters::NAME); })*
                names
            }

            /// Switches an effect on with its typical size times `factor`; `false` if there is none of that name.
            pub fn switch_on(&mut self, name: &str, factor: f64) -> bool {
                match name {
                    $($name => self.$module = Some($parameters::default().scaled(factor)),)*
                    _ => return false,
                }
                true
            }

            /// Switches an effect on as another device might have it: `seed` decides sign, time constants and places.
            pub fn switch_on_varied(&mut self, name: &str, factor: f64, seed: u64) -> bool {
                let random = &mut Random::stream(seed, name, 1);
                match name {
                    $($name => self.$module = Some($parameters::default().varied(random).scaled(factor)),)*
                    _ => return false,
                }
                true
            }

            /// # Errors
            /// The first parameter that an effect cannot have, and the effect's name.
            pub fn check(&self) -> Result<(), (&'static str, Fault)> {
                $(if let Some(parameters) = &self.$module {
                    parameters.check().map_err(|fault| ($name, fault))?;
                })*
                Ok(())
            }

            /// All effects that are switched on, at the moment the device was built.
            pub(crate) fn start(&self, setting: &Setting) -> Vec<Box<dyn Effect>> {
                let mut started = Vec::new();
                $(if let Some(parameters) = &self.$module { started.push(parameters.start(setting)); })*
                started
            }
        }
    };
}

effects! {
    "thermal-lag" thermal_lag ThermalLag;
    "warm-up" warm_up WarmUp;
    "thermal-gradient" thermal_gradient ThermalGradient;
    "misalignment" misalignment Misalignment;
    "cross-axis" cross_axis CrossAxis;
    "second-order" second_order SecondOrder;
    "third-order" third_order ThirdOrder;
    "g-hysteresis" g_hysteresis GHysteresis;
    "vibration-rectification" vibration_rectification VibrationRectification;
    "turn-on" turn_on TurnOn;
    "aging" aging Aging;
    "scale-factor-aging" scale_factor_aging ScaleFactorAging;
    "x-tide" x_tide Tide;
    "x-odd-quadratic" x_odd_quadratic OddQuadratic;
    "x-magnetic" x_magnetic Magnetic;
    "x-annealing-step" x_annealing_step AnnealingStep;
    "x-telegraph" x_telegraph Telegraph;
    "x-periodic-interference" x_periodic_interference PeriodicInterference;
    "thermal-hysteresis" thermal_hysteresis ThermalHysteresis;
    "stress-relaxation" stress_relaxation StressRelaxation;
    "pressure" pressure Pressure;
    "humidity" humidity Humidity;
    "supply-voltage" supply_voltage SupplyVoltage;
    "x-phase-error" x_phase_error PhaseError;
    "mode-crossing" mode_crossing ModeCrossing;
    "lock-in" lock_in LockIn;
    "reference-clock" reference_clock ReferenceClock;
}

#[cfg(test)]
mod one_effect;
#[cfg(test)]
mod tests;
