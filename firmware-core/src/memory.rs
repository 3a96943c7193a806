//! What an effect remembers of the past.
//!
//! Both kinds of memory are driven by *increments* of a signal, and increments are taken in
//! integers. The state is the small departure from equilibrium and not the signal itself: a low-pass
//! of 25 °C with a time constant of hours would stall in `f32`, its departure does not.

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
    departure: R,
    settled_for: R,
    settled: bool,
}

/// After this many time constants a lag has forgotten 99.3 % of its beginning.
const SETTLED_TAUS: f32 = 5.0;

impl<R: Real> State<R> {
    /// In equilibrium, as after an infinite soak. It settles as the past becomes known.
    pub const REST: Self = Self { departure: R::ZERO, settled_for: R::ZERO, settled: false };

    /// The departure from equilibrium, in the signal's unit.
    #[must_use]
    pub const fn departure(&self) -> R {
        self.departure
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
    }

    /// Exact for a signal that runs straight from one sample to the next.
    fn advance_lag(&mut self, tau_s: R, increment: R, dt_s: R) {
        if tau_s > R::ZERO {
            let k = dt_s / tau_s;
            let forgotten = -(-k).exp_m1();
            self.departure = self.departure - self.departure * forgotten + increment * (forgotten / k);
            self.settled_for += k;
            self.settled = self.settled_for >= R::from_f32(SETTLED_TAUS);
        } else {
            *self = Self { settled: true, ..Self::REST };
        }
    }

    fn advance_play(&mut self, radius: R, increment: R) {
        let radius = if radius > R::ZERO { radius } else { R::ZERO };
        let wanted = self.departure + increment;
        self.departure = wanted.between(-radius, radius);
        self.settled = self.settled || !(wanted > -radius && wanted < radius);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lag_follows_the_analytic_ramp_response_in_f32_over_ten_hours() {
        let (tau, rate) = (6000.0_f32, 0.01_f32);
        let (memory, mut state) = (Memory::Lag { tau_s: tau }, State::REST);
        for second in 1..=36_000 {
            state.advance(&memory, rate, 1.0);
            let exact = f64::from(rate) * 6000.0 * (1.0 - libm::exp(-f64::from(second) / 6000.0));
            // 36,000 roundings of half an ulp, not all the same way.
            assert!((f64::from(state.departure()) - exact).abs() < 60.0 * 1e-4, "at {second} s");
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
}
