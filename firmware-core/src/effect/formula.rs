//! What every effect's formula is: a pure function of one moment and its coefficients.

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
