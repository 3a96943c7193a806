//! Writing a calibration takes an unlock that no stray, repeated or delayed frame can perform.
//!
//! ```text
//!             challenge                right answer
//!   locked ───────────────▶ challenged ────────────▶ open
//!     ▲  wrong answer, 60 s     │                      │
//!     └─────────────────────────┴──────────────────────┘ one commit or one step back, whatever its outcome; 300 s
//! ```

use protocol::{Refusal, unlock_answer};

const ANSWER_WITHIN_US: u64 = 60_000_000;
const OPEN_FOR_US: u64 = 300_000_000;

/// The lock on the storage.
#[derive(Debug)]
pub struct Lock {
    state: State,
    since_us: u64,
    challenges: u32,
}

#[derive(Clone, Copy, Debug)]
enum State {
    Locked,
    Challenged { nonce: u64 },
    Open,
}

impl Lock {
    /// Locked.
    pub const fn new() -> Self {
        Self { state: State::Locked, since_us: 0, challenges: 0 }
    }

    /// A number that was not given before since power-on and, as nobody asks at the same microsecond
    /// twice, hardly ever before that.
    pub fn challenge(&mut self, time_us: u64) -> u64 {
        self.challenges = self.challenges.wrapping_add(1);
        let nonce = scattered(time_us ^ u64::from(self.challenges) << 40);
        self.enter(State::Challenged { nonce }, time_us);
        nonce
    }

    /// Opens the lock for the right answer in time; any other one needs a new challenge.
    ///
    /// # Errors
    /// [`Refusal::WrongAnswer`].
    pub fn answer(&mut self, answer: u32, serial: &str, time_us: u64) -> Result<(), Refusal> {
        let state = core::mem::replace(&mut self.state, State::Locked);
        match state {
            State::Challenged { nonce }
                if self.within(ANSWER_WITHIN_US, time_us) && answer == unlock_answer(nonce, serial) =>
            {
                self.enter(State::Open, time_us);
                Ok(())
            }
            _ => Err(Refusal::WrongAnswer),
        }
    }

    /// Whether writing is allowed now.
    ///
    /// # Errors
    /// [`Refusal::Locked`].
    pub fn check(&self, time_us: u64) -> Result<(), Refusal> {
        match self.state {
            State::Open if self.within(OPEN_FOR_US, time_us) => Ok(()),
            _ => Err(Refusal::Locked),
        }
    }

    /// Locks again.
    pub const fn close(&mut self) {
        self.state = State::Locked;
    }

    const fn enter(&mut self, state: State, time_us: u64) {
        self.state = state;
        self.since_us = time_us;
    }

    /// A clock that runs backwards is no reason to stay open.
    fn within(&self, duration_us: u64, time_us: u64) -> bool {
        time_us.checked_sub(self.since_us).is_some_and(|passed_us| passed_us < duration_us)
    }
}

/// Every bit of the result depends on every bit of the number (the finaliser of SplitMix64, a bijection).
const fn scattered(number: u64) -> u64 {
    let number = (number ^ (number >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    number ^ (number >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opened(answered_us: u64) -> (Lock, Result<(), Refusal>) {
        let mut lock = Lock::new();
        let nonce = lock.challenge(1_000);
        let result = lock.answer(unlock_answer(nonce, "SN"), "SN", answered_us);
        (lock, result)
    }

    #[test]
    fn only_the_right_answer_in_time_opens_it() {
        assert_eq!(opened(60_000_999).1, Ok(()));
        assert_eq!(opened(60_001_000).1, Err(Refusal::WrongAnswer), "too late");
        assert_eq!(opened(999).1, Err(Refusal::WrongAnswer), "the clock ran backwards");
        let mut lock = Lock::new();
        let nonce = lock.challenge(0);
        assert_eq!(lock.answer(unlock_answer(nonce, "SN") ^ 1, "SN", 1), Err(Refusal::WrongAnswer));
        assert_eq!(lock.answer(unlock_answer(nonce, "SN"), "SN", 1), Err(Refusal::WrongAnswer), "one try a challenge");
        assert_eq!(Lock::new().answer(unlock_answer(0, "SN"), "SN", 0), Err(Refusal::WrongAnswer), "no challenge");
    }

    #[test]
    fn it_closes_after_use_and_by_time() {
        let (mut lock, _) = opened(2_000);
        assert_eq!(lock.check(300_001_999), Ok(()));
        assert_eq!(lock.check(300_002_000), Err(Refusal::Locked));
        assert_eq!(lock.check(1_999), Err(Refusal::Locked), "the clock ran backwards");
        lock.close();
        assert_eq!(lock.check(2_000), Err(Refusal::Locked));
    }

    #[test]
    fn no_two_challenges_are_alike() {
        // From power-on, and after weeks without a break, when the clock needs more bits.
        for begun_us in [0, 0x3F << 40] {
            let mut lock = Lock::new();
            let mut nonces = [0; 64];
            nonces.iter_mut().enumerate().for_each(|(i, nonce)| *nonce = lock.challenge(begun_us + i as u64 / 2));
            nonces.sort_unstable();
            assert!(nonces.windows(2).all(|pair| pair[0] != pair[1]));
        }
    }

    #[test]
    fn a_nonce_is_scattered_as_the_published_generator_does_it() {
        // SplitMix64 from seed 0: the finaliser of multiples of the golden ratio.
        const STEP: u64 = 0x9E37_79B9_7F4A_7C15;
        assert_eq!(scattered(STEP), 0xE220_A839_7B1D_CDAF);
        assert_eq!(scattered(STEP.wrapping_mul(2)), 0x6E78_9E6A_A1B9_65F4);
        assert_eq!(scattered(STEP.wrapping_mul(3)), 0x06C4_5D18_8009_454F);
    }
}
