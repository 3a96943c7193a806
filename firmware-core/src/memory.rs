//! What an effect remembers of the past.
//!
//! Both kinds of memory are driven by *increments* of a signal, and increments are taken in
//! integers where the signal is one. The state is the small departure from equilibrium and not the
//! signal itself, and it is summed without loss: a low-pass of 25 °C with a time constant of hours
//! would stall in `f32`, its departure does not, be the samples ever so dense.

use crate::real::Real;

/// How an effect remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory<R> {
    /// Not at all.
    None,
    /// First-order lag: the state is the signal minus its low-pass, q̇ = −q/τ + ṡ.
    Lag {
        /// Time constant, s.
        tau_s: R,
    },
    /// Play (backlash) operator of Prandtl and Ishlinskii: the state is the distance by which the
    /// output trails the signal, at most `radius`.
    Play {
        /// Half width of the play, in the signal's unit.
        radius: R,
    },
}

/// The present state of one memory, and whether it has forgotten its unknown beginning.
#[derive(Clone, Copy, Debug)]
pub struct State<R> {
    departure: Sum<R>,
    /// Time constants gone by.
    settled_for: Sum<R>,
    settled: bool,
}

/// After this many time constants a lag has forgotten 99.3 % of its beginning.
const SETTLED_TAUS: f32 = 5.0;

impl<R: Real> State<R> {
    /// In equilibrium, as after an infinite soak. It settles as the past becomes known.
    pub const REST: Self = Self { departure: Sum::ZERO, settled_for: Sum::ZERO, settled: false };

    /// The departure from equilibrium, in the signal's unit.
    #[must_use]
    pub const fn departure(&self) -> R {
        self.departure.value
    }

    /// Whether the past seen so far determines the state.
    #[must_use]
    pub const fn is_settled(&self) -> bool {
        self.settled
    }

    /// Takes the signal's `increment` during `dt_s`, which is positive.
    pub fn advance(&mut self, memory: &Memory<R>, increment: R, dt_s: R) {
        match *memory {
            Memory::None => self.settled = true,
            Memory::Lag { tau_s } => self.advance_lag(tau_s, increment, dt_s),
            Memory::Play { radius } => self.advance_play(radius, increment),
        }
        if !self.departure.value.is_finite() {
            // An impossible signal must not be remembered for ever.
            *self = Self::REST;
        }
    }

    /// Takes the signal's `increment` over a pause of `dt_s`, during which nobody looked. As much of it as would have come
    /// had the signal gone on as before comes at that pace: a ramp does not stop because a table turns. The rest moved and
    /// then waited, as chamber and turntable do: it counts from the beginning.
    pub fn pause(&mut self, memory: &Memory<R>, increment: R, dt_s: R) {
        let steady = match *memory {
            // A lag's departure over its time constant is the signal's rate, smoothed over just the time that matters.
            Memory::Lag { tau_s } if tau_s > R::ZERO => {
                between_zero_and(increment, self.departure.value / tau_s * dt_s)
            }
            Memory::Lag { .. } | Memory::None | Memory::Play { .. } => increment,
        };
        self.departure.add(increment - steady);
        self.advance(memory, steady, dt_s);
    }

    /// Exact for a signal that runs straight from one sample to the next.
    fn advance_lag(&mut self, tau_s: R, increment: R, dt_s: R) {
        if tau_s > R::ZERO {
            let k = dt_s / tau_s;
            let forgotten = -(-k).exp_m1();
            let kept = if k > R::ZERO { forgotten / k } else { R::ONE };
            self.departure.add(increment * kept - self.departure.value * forgotten);
            self.settled_for.add(k);
            self.settled = self.settled_for.value >= R::from_f32(SETTLED_TAUS);
        } else {
            *self = Self { settled: true, ..Self::REST };
        }
    }

    fn advance_play(&mut self, radius: R, increment: R) {
        let radius = if radius > R::ZERO { radius } else { R::ZERO };
        let wanted = self.departure.value + increment;
        self.departure = Sum { value: wanted.between(-radius, radius), ..Sum::ZERO };
        self.settled = self.settled || !(wanted > -radius && wanted < radius);
    }
}

/// The value, or the nearer of zero and `end` where it is not between them.
fn between_zero_and<R: Real>(end: R, value: R) -> R {
    if end < R::ZERO { value.between(end, R::ZERO) } else { value.between(R::ZERO, end) }
}

/// A sum to which steps below its last place still count (Kahan).
#[derive(Clone, Copy, Debug)]
struct Sum<R> {
    value: R,
    /// What rounding has kept from the value so far.
    carry: R,
}

impl<R: Real> Sum<R> {
    const ZERO: Self = Self { value: R::ZERO, carry: R::ZERO };

    fn add(&mut self, step: R) {
        let step = step + self.carry;
        let sum = self.value + step;
        self.carry = step - (sum - self.value);
        self.value = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lag_of_days_does_not_stall_in_f32_at_a_hundred_samples_a_second() {
        let (tau, start) = (1e6_f32, 35.0_f32);
        let (memory, mut state) = (Memory::Lag { tau_s: tau }, State::REST);
        state.advance(&memory, start, 0.01);
        for _ in 0..1_000_000 {
            state.advance(&memory, 0.0, 0.01);
        }
        let exact = 35.0 * libm::exp(-0.01);
        assert!((f64::from(state.departure()) - exact).abs() < 2e-6 * 35.0, "{} for {exact}", state.departure());
        assert!((state.settled_for.value - 0.01).abs() < 2e-8 && !state.is_settled());
    }

    #[test]
    fn a_change_during_a_pause_counts_from_its_beginning() {
        let (lag, play) = (Memory::Lag { tau_s: 600.0_f64 }, Memory::Play { radius: 2.0_f64 });
        let mut state = State::REST;
        state.pause(&lag, 20.0, 1200.0);
        assert!((state.departure() - 20.0 * libm::exp(-2.0)).abs() < 1e-12);
        let mut state = State::REST;
        state.pause(&play, 20.0, 1200.0);
        assert!((state.departure() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_ramp_goes_on_through_a_pause_and_what_it_does_not_explain_counts_from_its_beginning() {
        let lag = Memory::Lag { tau_s: 46.5_f64 };
        for rate in [0.02, -0.02] {
            let mut state = State::REST;
            let mut without_a_pause = state;
            for _ in 0..100 {
                state.advance(&lag, 10.0 * rate, 10.0);
            }
            without_a_pause.clone_from(&state);
            without_a_pause.advance(&lag, 40.0 * rate, 40.0);
            let ramp = state;
            state.pause(&lag, 40.0 * rate, 40.0);
            assert!((state.departure() - without_a_pause.departure()).abs() < 1e-6, "{rate}");
            // The ramp turned: nothing of what came is its own.
            let mut turned = ramp;
            turned.pause(&lag, -5.0 * rate, 40.0);
            let kept = libm::exp(-40.0 / 46.5);
            assert!((turned.departure() - (ramp.departure() - 5.0 * rate) * kept).abs() < 1e-12, "{rate}");
            // And a step of the chamber beside it.
            let mut stepped = ramp;
            stepped.pause(&lag, 40.0 * rate + 100.0 * rate, 40.0);
            assert!((stepped.departure() - without_a_pause.departure() - 100.0 * rate * kept).abs() < 1e-6, "{rate}");
        }
    }

    #[test]
    fn an_impossible_signal_is_forgotten() {
        for memory in [Memory::Lag { tau_s: 35.0_f32 }, Memory::Lag { tau_s: f32::MAX }] {
            let mut state = State::REST;
            state.advance(&memory, f32::INFINITY, 1e-6);
            assert!(state.departure().to_bits() == 0, "{memory:?}");
            state.advance(&memory, 1.0, 1e-6);
            assert!((state.departure() - 1.0).abs() < 1e-6, "{memory:?}");
        }
    }

    #[test]
    fn a_lag_follows_the_analytic_ramp_response_in_f32_over_ten_hours() {
        let (tau, rate) = (6000.0_f32, 0.01_f32);
        let (memory, mut state) = (Memory::Lag { tau_s: tau }, State::REST);
        for second in 1..=36_000 {
            state.advance(&memory, rate, 1.0);
            let exact = f64::from(rate) * 6000.0 * (1.0 - libm::exp(-f64::from(second) / 6000.0));
            // The increment and the share that is forgotten are rounded once each, always the same way.
            assert!((f64::from(state.departure()) - exact).abs() < 60.0 * 1e-6, "at {second} s");
        }
        assert!(state.is_settled());
    }

    #[test]
    fn a_lag_is_independent_of_the_sampling_for_a_straight_signal() {
        let memory = Memory::Lag { tau_s: 35.0_f64 };
        let (mut fine, mut coarse) = (State::REST, State::REST);
        for _ in 0..10 {
            coarse.advance(&memory, 1.0, 10.0);
            for _ in 0..10 {
                fine.advance(&memory, 0.1, 1.0);
            }
        }
        assert!((fine.departure() - coarse.departure()).abs() < 1e-12);
    }

    #[test]
    fn a_play_trails_by_its_radius_and_forgets_minor_loops() {
        let (memory, mut state) = (Memory::Play { radius: 2.0_f64 }, State::REST);
        state.advance(&memory, 1.5, 1.0);
        assert!(!state.is_settled());
        state.advance(&memory, 10.0, 1.0);
        assert!((state.departure() - 2.0).abs() < 1e-12 && state.is_settled());
        state.advance(&memory, -3.0, 1.0);
        assert!((state.departure() + 1.0).abs() < 1e-12);
        state.advance(&memory, 3.0, 1.0);
        assert!((state.departure() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_lag_of_no_time_follows_at_once_and_is_settled_for_good() {
        for tau_s in [0.0, -1.0] {
            let mut state = State::REST;
            for _ in 0..3 {
                state.advance(&Memory::Lag { tau_s }, 5.0_f32, 1.0);
                assert_eq!((state.departure(), state.is_settled()), (0.0, true), "{tau_s} s");
            }
        }
    }

    #[test]
    fn a_step_whose_share_of_the_time_constant_is_no_number_above_zero_still_counts() {
        let mut state = State::REST;
        state.advance(&Memory::Lag { tau_s: f32::MAX }, 1.0, 1e-8);
        assert_eq!(state.departure().to_bits(), 1.0_f32.to_bits());
    }

    #[test]
    fn a_play_that_just_reaches_either_end_knows_where_it_is() {
        for (increment, settled) in [(1.0_f32, true), (-1.0, true), (0.75, false), (-0.75, false)] {
            let mut state = State::REST;
            state.advance(&Memory::Play { radius: 1.0 }, increment, 1.0);
            assert_eq!((state.departure(), state.is_settled()), (increment, settled));
        }
    }
}
