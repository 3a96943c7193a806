//! What an effect is: parameters that a scenario may state, and what they become while a campaign is simulated.

use crate::limit::Fault;
use crate::twin::conditions::{Conditions, Forks, Input};
use crate::twin::random::Random;
use crate::twin::rig::Rig;
use crate::twin::static_map::StaticMap;
use crate::twin::truth::Truth;

/// An effect while it is simulated: parameters and memory.
pub trait Effect {
    /// A run begins, power comes on: draw what is drawn once a run.
    fn begin_run(&mut self) {}

    /// `dt_s` seconds have passed and led to `now`; also called while nothing is recorded and between runs.
    fn advance(&mut self, _now: &Conditions, _dt_s: f64) {}

    /// Acts on what reaches the forks.
    fn act(&self, _now: &Conditions, _input: &mut Input) {}

    /// Acts on the oscillating forks.
    fn pull(&self, _now: &Conditions, _forks: &mut Forks) {}
}

/// The parameters of an effect: what a scenario writes under `[effects.NAME]`.
pub trait Switch: Default {
    /// The effect's name.
    const NAME: &'static str;

    /// # Errors
    /// The first parameter that the effect cannot have.
    fn check(&self) -> Result<(), Fault>;

    /// The same effect, so much stronger that its influence on the reading grows by about `factor`.
    #[must_use]
    fn scaled(&self, factor: f64) -> Self;

    /// The same effect in another device: sign, time constants and places as the literature's range allows.
    #[must_use]
    fn varied(&self, random: &mut Random) -> Self;

    /// The effect at the moment the device was built.
    fn start(&self, setting: &Setting) -> Box<dyn Effect>;
}

/// What an effect may know when it starts.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// The device.
    pub truth: &'a Truth,
    /// The device without effects, as a function.
    pub map: &'a StaticMap,
    /// The laboratory.
    pub rig: &'a Rig,
    /// The seed of the simulation.
    pub seed: u64,
}

impl Setting<'_> {
    /// The effect's own stream of random numbers.
    pub(super) fn random(&self, name: &str) -> Random {
        Random::stream(self.seed, name, 0)
    }

    /// K1 at the reference temperature, by which an effect stated as bias becomes a frequency, Hz/µg.
    pub(super) fn hz_per_ug(&self) -> f64 {
        self.map.scale_factor_hz_per_g(self.truth.reference_temperature_c) * 1e-6
    }
}

/// How much of a common shift by package stress shows in the difference of the forks: 1–5 % for a symmetric die.
pub(super) const STRESS_MISMATCH: f64 = 0.03;
/// How much of a common shift by drive amplitude, polarisation or charge shows in the difference of the forks.
pub(super) const DRIVE_MISMATCH: f64 = 0.1;
