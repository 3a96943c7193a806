//! The effects of a calibration at work: their coefficients and what they remember.
//!
//! Apart from the compensator because training runs the same effects over measurements whose level
//! is known from the reference, without a network.

use crate::effect::{self, Coefficients, Disturbance, Effect, Moment, Signal};
use crate::load_error::LoadError;
use crate::memory::{Memory, State};
use crate::observe::{Clock, Observation, Step};
use crate::program::{Program, ProgramError, Reads};
use crate::real::Real;
use heapless::Vec;
use protocol::limits::{MAX_CHANNELS, MAX_PARAMETERS, MAX_TERMS};
use protocol::{Sample, Status};

/// Effects with coefficients and memories.
#[derive(Clone)]
pub struct Terms<R: Real> {
    clock: Clock,
    /// At the sample that the clock measures from, g.
    last_level_g: R,
    terms: Vec<Term<R>, MAX_TERMS>,
}

#[derive(Clone)]
struct Term<R: Real> {
    effect: &'static dyn Effect<R>,
    coefficients: Coefficients<R>,
    channel: usize,
    program: Program,
    reads: Reads,
    memory: Memory<R>,
    state: State<R>,
    measured: bool,
}

/// What memories follow, at one instant.
#[derive(Clone, Copy)]
struct Instant<'a, R> {
    sample: &'a Sample,
    level_g: R,
}

impl<R: Real> Terms<R> {
    /// No effects; memories start anew after a gap of more than `max_gap_us`.
    #[must_use]
    pub const fn new(max_gap_us: u32) -> Self {
        Self { clock: Clock::new(max_gap_us), last_level_g: R::ZERO, terms: Vec::new() }
    }

    /// Adds the effect of number `id`, which follows entry `channel` of `channels` if it follows one, and whose
    /// formula is `program` if it takes one.
    ///
    /// # Errors
    /// [`LoadError`] if it is unknown, takes other coefficients, its program can't be run, or there is no room.
    pub fn push(
        &mut self,
        id: u16,
        channel: usize,
        channels: usize,
        parameters: impl ExactSizeIterator<Item = R>,
        program: &[u8],
    ) -> Result<(), LoadError> {
        let effect = effect::find::<R>(id).ok_or(LoadError::UnknownEffect(id))?;
        let (found, expected) = (parameters.len(), effect.coefficients());
        if found != expected {
            return Err(LoadError::Coefficients { effect: id, found, expected });
        }
        let program = checked(effect, program).map_err(|why| LoadError::Program { effect: id, why })?;
        let reads = reads(effect, channel, &program).ok_or(LoadError::Channel { effect: id })?;
        if u32::from(reads.channels) >> channels.min(MAX_CHANNELS) != 0 {
            return Err(LoadError::Channel { effect: id });
        }
        let mut coefficients = [R::ZERO; MAX_PARAMETERS];
        coefficients.iter_mut().zip(parameters).for_each(|(slot, value)| *slot = value);
        let memory = if reads.past { effect.memory(&coefficients) } else { Memory::None };
        let (state, measured) = (State::REST, false);
        let term = Term { effect, coefficients, channel, program, reads, memory, state, measured };
        self.terms.push(term).map_err(|_| LoadError::TooManyEffects)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// Forgets the past.
    pub fn restart(&mut self) {
        self.clock.restart();
        self.terms.iter_mut().for_each(|term| term.state = State::REST);
    }

    /// Takes the next sample and its level into the memories; returns what to flag. The level is the
    /// static reading on the device, the reference in training, g.
    pub fn advance(&mut self, sample: &Sample, level_g: R) -> Status {
        let (step, mut status) = self.clock.step(sample);
        let last = self.clock.last().map(|sample| Instant { sample, level_g: self.last_level_g });
        let now = Instant { sample, level_g };
        for term in &mut self.terms {
            term.remember(step, &now, last.as_ref());
            status |= term.flags();
        }
        if step != Step::Held {
            self.last_level_g = level_g;
        }
        self.clock.pass(sample, step);
        status
    }

    /// What the effects do to the resonators at this moment.
    pub fn disturbance(&self, now: &Observation<R>, level_g: R) -> Disturbance<R> {
        let mut sum = Disturbance::NONE;
        for term in self.terms.iter().filter(|term| term.measured) {
            sum += term.effect.disturb(&term.moment(now, level_g), &term.coefficients);
        }
        sum
    }

    /// What the effects add to the output at this moment, g.
    pub fn bias_g(&self, now: &Observation<R>, level_g: R) -> R {
        let mut sum = R::ZERO;
        for term in self.terms.iter().filter(|term| term.measured) {
            sum += term.effect.bias_g(&term.moment(now, level_g), &term.coefficients);
        }
        sum
    }
}

impl<R: Real> Term<R> {
    fn remember(&mut self, step: Step, now: &Instant<'_, R>, last: Option<&Instant<'_, R>>) {
        self.measured = self.is_measured(now.sample);
        let last = last.filter(|last| self.measured && self.is_measured(last.sample));
        match (step, last) {
            (Step::Held, _) => {}
            (Step::Forward(gap_us), Some(last)) => {
                self.state.advance(&self.memory, self.increment(now, last), seconds(gap_us));
            }
            (Step::Paused(gap_us), Some(last)) => {
                self.state.pause(&self.memory, self.increment(now, last), seconds(gap_us));
            }
            _ => self.state = State::REST,
        }
    }

    /// Whether the sample has what this effect depends on.
    fn is_measured(&self, sample: &Sample) -> bool {
        let aged = !self.reads.age || sample.age_s.is_some();
        let missing = |(channel, value): (usize, &i64)| {
            u32::from(self.reads.channels) >> channel & 1 != 0 && *value == Sample::NOT_MEASURED
        };
        aged && !sample.channels.iter().enumerate().any(missing)
    }

    fn channel_of(&self, sample: &Sample) -> i64 {
        sample.channels.get(self.channel).copied().unwrap_or(Sample::NOT_MEASURED)
    }

    /// By how much the signal that this effect follows changed; what was measured is differenced as integers.
    fn increment(&self, now: &Instant<'_, R>, last: &Instant<'_, R>) -> R {
        let temperature_uc = |instant: &Instant<'_, R>| i64::from(instant.sample.temperature_uc);
        let channel = |instant: &Instant<'_, R>| self.channel_of(instant.sample);
        match self.effect.signal() {
            Signal::Temperature => R::from_micro(temperature_uc(now) - temperature_uc(last)),
            Signal::Channel => R::from_micro(channel(now).saturating_sub(channel(last))),
            Signal::Level => now.level_g - last.level_g,
        }
    }

    fn moment<'a>(&'a self, now: &'a Observation<R>, level_g: R) -> Moment<'a, R> {
        Moment {
            now,
            departure: self.state.departure(),
            channel: now.channels.get(self.channel).copied().unwrap_or(R::ZERO),
            level_g,
            program: &self.program,
        }
    }

    fn flags(&self) -> Status {
        let mut status = Status::empty();
        status.set(Status::SETTLING, self.memory != Memory::None && !self.state.is_settled());
        status.set(Status::CHANNEL_MISSING, !self.measured);
        status
    }
}

/// The program of an effect that takes one, and of one that takes none.
fn checked<R: Real>(effect: &dyn Effect<R>, program: &[u8]) -> Result<Program, ProgramError> {
    match (effect.takes_program(), program) {
        (true, code) => Program::new(code),
        (false, []) => Ok(Program::NONE),
        (false, _) => Err(ProgramError::Surplus),
    }
}

/// What a sample must have for an effect to be computed; `None` if no sample has that channel.
fn reads<R: Real>(effect: &dyn Effect<R>, channel: usize, program: &Program) -> Option<Reads> {
    if effect.takes_program() {
        return Some(program.reads());
    }
    let followed = effect.signal() == Signal::Channel;
    let bit = u32::try_from(channel).ok().and_then(|channel| 1_u8.checked_shl(channel));
    let channels = if followed { bit? } else { 0 };
    Some(Reads { past: true, age: effect.needs_age(), channels })
}

fn seconds<R: Real>(us: u64) -> R {
    R::from_micro(i64::try_from(us).unwrap_or(i64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_empty_until_one_is_added() {
        let mut terms = Terms::<f32>::new(u32::MAX);
        assert!(terms.is_empty());
        terms.push(1, 0, 0, [35.0].into_iter(), &[]).expect("a lag");
        assert!(!terms.is_empty());
    }
}
