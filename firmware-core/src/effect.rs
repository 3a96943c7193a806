//! Physical effects beside the network: pure functions of one moment and their coefficients.
//!
//! History is observed once ([`Memory`]); effects only look. Each is one file with the same
//! skeleton: what happens physically, [`About`], [`Effect`], tests. A coefficient has the sign and
//! unit of the physics (what the effect *does* to the sensor); the compensator takes it out again.
//! `docs/adding-an-effect.md` shows how to write the next one.

mod aging;
#[cfg(test)]
mod bench;
mod cross_axis;
mod expression;
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

use crate::memory::Memory;
use crate::observe::Observation;
use crate::program::Program;
use crate::real::Real;
use core::ops::AddAssign;
use protocol::limits::MAX_PARAMETERS;

/// An effect's coefficients in its own order and units, unused ones zero.
pub type Coefficients<R> = [R; MAX_PARAMETERS];

/// What an effect does, in the arithmetic `R`.
pub trait Effect<R: Real>: Sync {
    /// How many coefficients it takes.
    fn coefficients(&self) -> usize;

    /// Which signal its memory follows.
    fn signal(&self) -> Signal {
        Signal::Temperature
    }

    /// How it remembers that signal.
    fn memory(&self, _coefficients: &Coefficients<R>) -> Memory<R> {
        Memory::None
    }

    /// Whether it needs the calendar age.
    fn needs_age(&self) -> bool {
        false
    }

    /// Whether its formula is a program that comes with its coefficients.
    fn takes_program(&self) -> bool {
        false
    }

    /// What it does to the resonators before they vibrate.
    fn disturb(&self, _moment: &Moment<R>, _coefficients: &Coefficients<R>) -> Disturbance<R> {
        Disturbance::NONE
    }

    /// What it adds to the output, g.
    fn bias_g(&self, _moment: &Moment<R>, _coefficients: &Coefficients<R>) -> R {
        R::ZERO
    }
}

/// A signal that an effect follows through time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// The thermometer.
    Temperature,
    /// The auxiliary channel that the term names.
    Channel,
    /// The static reading, g: as if no effect were at work.
    Level,
}

/// What an effect sees of one instant.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a, R> {
    /// The present observation.
    pub now: &'a Observation<R>,
    /// How far the remembered signal is from equilibrium, in the signal's unit.
    pub departure: R,
    /// The value of the effect's auxiliary channel.
    pub channel: R,
    /// The static reading, g.
    pub level_g: R,
    /// The effect's own formula, where it takes one.
    pub program: &'a Program,
}

/// What effects do to the resonators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance<R> {
    /// Resonators minus thermometer, °C.
    pub temperature_c: R,
    /// Frequency difference with the effect minus without it, Hz.
    pub delta_f_hz: R,
}

impl<R: Real> Disturbance<R> {
    /// Nothing.
    pub const NONE: Self = Self { temperature_c: R::ZERO, delta_f_hz: R::ZERO };

    /// Resonators warmer than the thermometer by this, °C.
    pub const fn of_temperature(temperature_c: R) -> Self {
        Self { temperature_c, delta_f_hz: R::ZERO }
    }

    /// A frequency difference larger by this than without the effect, Hz.
    pub const fn of_delta_f(delta_f_hz: R) -> Self {
        Self { temperature_c: R::ZERO, delta_f_hz }
    }
}

impl<R: Real> AddAssign for Disturbance<R> {
    fn add_assign(&mut self, other: Self) {
        self.temperature_c += other.temperature_c;
        self.delta_f_hz += other.delta_f_hz;
    }
}

/// What a person should know of an effect. The device never links this.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Its number on the wire. Released numbers keep their formula for ever.
    pub id: u16,
    /// Its name on the command line, in model files and in reports.
    pub name: &'static str,
    /// What happens, in a sentence or two of plain language.
    pub summary: &'static str,
    /// The formula.
    pub equation: &'static str,
    /// Where the formula comes from.
    pub source: &'static str,
    /// Its coefficients in order.
    pub parameters: &'static [Parameter],
    /// The auxiliary channel that it follows, if any.
    pub channel: Option<&'static str>,
    /// What it does to the sum of the frequencies.
    pub sum_response: SumResponse,
    /// What a campaign must contain to show it.
    pub needs: &'static str,
}

impl About {
    /// Whether an instrument can take the effect out. One that is new at every start can be known, not predicted.
    #[must_use]
    pub fn is_on_device(&self) -> bool {
        find::<f32>(self.id).is_some()
    }

    /// Whether its formula is a user's own expression.
    #[must_use]
    pub fn takes_program(&self) -> bool {
        find::<f32>(self.id).is_some_and(Effect::takes_program)
    }

    /// Whether only a signal that is a frequency can have it: what locks in, or is counted with a clock.
    #[must_use]
    pub fn needs_frequency(&self) -> bool {
        matches!(self.name, "lock-in" | "reference-clock")
    }
}

/// One coefficient of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name, with the unit at the end.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// How a fit treats it.
    pub role: Role,
    /// Where a fit starts.
    pub start: f64,
    /// The least value that makes physical sense.
    pub low: f64,
    /// The greatest value that makes physical sense.
    pub high: f64,
    /// What sensors of this kind have: a plan takes it where no measurement says better.
    pub typical: f64,
    /// At which of the bounds the formula has a limit that makes sense: a fit that ends there is none that was stopped.
    pub sound_limit: SoundLimit,
}

/// Bounds at which a formula has a limit that makes sense: a rate not smoothed, a drift that does not end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoundLimit {
    /// At neither: what ends there is something else.
    Neither,
    /// At the lower one.
    Low,
    /// At the upper one.
    High,
    /// At both.
    Both,
}

impl SoundLimit {
    /// Whether the lower bound is one.
    #[must_use]
    pub const fn is_low(self) -> bool {
        matches!(self, Self::Low | Self::Both)
    }

    /// Whether the upper bound is one.
    #[must_use]
    pub const fn is_high(self) -> bool {
        matches!(self, Self::High | Self::Both)
    }
}

/// What an effect does to the sum of the frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SumResponse {
    /// What it does to temperature and difference predicts it: warmer resonators, another clock.
    Predicted,
    /// In proportion to its bias, by at most so many times what the difference moves.
    Free(f64),
}

impl SumResponse {
    /// Heat between the forks moves the sum by less than the difference.
    pub const GRADIENT: Self = Self::Free(2.0);
    /// Drive, charge and electronics move the sum ten times as much as the difference.
    pub const ELECTRONICS: Self = Self::Free(40.0);
    /// Stress of the package moves the sum up to a hundred times as much as the difference.
    pub const STRESS: Self = Self::Free(400.0);

    /// Whether the effect predicts the sum.
    #[must_use]
    pub const fn is_predicted(self) -> bool {
        matches!(self, Self::Predicted)
    }
}

/// How a fit treats a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The effect is proportional to it and vanishes with it.
    Amplitude,
    /// It shapes the effect: a time constant or a width, positive, searched on a logarithmic scale.
    Shape,
    /// Where the effect's channel counts from. A fit can't tell it from the bias: the channel's mean is taken.
    Origin,
    /// Where on an axis the effect sits: of either sign, searched on a linear scale.
    Location,
}

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
