//! Physical effects beside the network: pure functions of one moment and their coefficients.
//!
//! History is observed once ([`Memory`](crate::Memory)); effects only look. Each is one file with the same
//! skeleton: what happens physically, [`About`], [`Effect`], tests. A coefficient has the sign and
//! unit of the physics (what the effect *does* to the sensor); the compensator takes it out again.
//! `docs/adding-an-effect.md` shows how to write the next one.

mod about;
mod aging;
#[cfg(test)]
mod bench;
mod cross_axis;
mod expression;
mod formula;
mod g_hysteresis;
mod humidity;
mod lock_in;
mod misalignment;
mod mode_crossing;
mod pressure;
mod reference_clock;
mod scale_factor_aging;
mod second_order;
mod self_heating;
mod stress_relaxation;
mod supply_voltage;
mod thermal_gradient;
mod thermal_hysteresis;
mod thermal_lag;
mod third_order;
mod turn_on;
mod vibration_rectification;
mod warm_up;

pub use about::{About, Parameter, Role, SoundLimit, SumResponse};
pub use formula::{Coefficients, Disturbance, Effect, Moment, Signal};

use crate::real::Real;

// A module without a type is known and can't be computed: see `About::is_on_device`.
macro_rules! registry {
    ($($module:ident $(:: $effect:ident)?),* $(,)?) => {
        /// What a person should know of every effect, by number.
        pub const ALL: &[&About] = &[$(&$module::ABOUT),*];

        /// The effect of this number, as far as an instrument can compute it.
        #[must_use]
        pub fn find<R: Real>(id: u16) -> Option<&'static dyn Effect<R>> {
            $($(if id == $module::ABOUT.id { return Some(&$module::$effect); })?)*
            None
        }
    };
}

registry! {
    thermal_lag::ThermalLag,
    thermal_gradient::ThermalGradient,
    warm_up::WarmUp,
    thermal_hysteresis::ThermalHysteresis,
    second_order::SecondOrder,
    supply_voltage::SupplyVoltage,
    stress_relaxation::StressRelaxation,
    aging::Aging,
    scale_factor_aging::ScaleFactorAging,
    third_order::ThirdOrder,
    cross_axis::CrossAxis,
    misalignment::Misalignment,
    vibration_rectification::VibrationRectification,
    pressure::Pressure,
    humidity::Humidity,
    mode_crossing::ModeCrossing,
    lock_in::LockIn,
    turn_on,
    g_hysteresis::GHysteresis,
    reference_clock::ReferenceClock,
    self_heating::SelfHeating,
    expression::Expression,
}

/// The highest effect number.
pub const HIGHEST: u16 = {
    let mut highest = 0;
    let mut i = 0;
    while i < ALL.len() {
        if ALL[i].id > highest {
            highest = ALL[i].id;
        }
        i += 1;
    }
    highest
};

/// What a person should know of the effect of this name.
#[must_use]
pub fn about(name: &str) -> Option<&'static About> {
    ALL.iter().copied().find(|about| about.name == name)
}

#[cfg(test)]
mod tests {
    use super::{ALL, Effect, HIGHEST, Parameter, find};

    #[test]
    fn what_is_said_of_an_effect_is_what_the_instrument_does() {
        for about in ALL {
            let computed = find::<f32>(about.id);
            assert_eq!(about.is_on_device(), computed.is_some(), "{}", about.name);
            assert_eq!(about.takes_program(), computed.is_some_and(Effect::takes_program), "{}", about.name);
        }
    }

    #[test]
    fn what_locks_in_or_is_counted_with_a_clock_needs_a_frequency() {
        let needing: [Option<&str>; 3] = {
            let mut names = ALL.iter().filter(|about| about.needs_frequency).map(|about| about.name);
            core::array::from_fn(|_| names.next())
        };
        assert_eq!(needing, [Some("lock-in"), Some("reference-clock"), None]);
    }

    #[test]
    fn every_coefficient_has_room_around_where_a_fit_starts() {
        for about in ALL {
            for Parameter { name, start, low, high, .. } in about.parameters {
                assert!(low < high && (low..=high).contains(&start), "{}, {name}: {low}, {start}, {high}", about.name);
            }
        }
    }

    #[test]
    fn the_highest_number_is_the_last_that_was_given() {
        assert_eq!(HIGHEST as usize, ALL.len(), "numbers go from 1 up without a gap");
        assert!(ALL.iter().all(|about| (1..=HIGHEST).contains(&about.id)));
    }
}
