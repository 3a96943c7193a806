//! Claim: whatever is asked in whatever order, over a line that spoils frames and with power that fails, the
//! instrument answers as a simple model of it does, and is in the model's state.
//!
//! Thousands of conversations, always the same ones. Each is a host that works towards a calibration of its choice and
//! is interrupted: by other requests, repeated numbers, broken frames, time, restarts, a flash that takes nothing.

#[path = "conversation/pool.rs"]
mod pool;
#[path = "conversation/reference.rs"]
mod reference;
#[path = "conversation/talk.rs"]
mod talk;

use firmware_core::FactoryKey;
use pool::Pool;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use talk::{Seen, Talk};

const CONVERSATIONS: u64 = 1_000;
const STEPS: usize = 120;

/// Numbers for one conversation.
pub struct Dice(Xoshiro256PlusPlus);

impl Dice {
    /// One of `0..sides`.
    fn roll(&mut self, sides: u64) -> u64 {
        self.0.next_u64() % sides
    }

    /// True so many times in a hundred.
    fn percent(&mut self, times: u64) -> bool {
        self.roll(100) < times
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.roll(from.len() as u64) as usize]
    }
}

/// Plays conversations with instruments that hold this kind of key.
fn converse(key: FactoryKey) -> Seen {
    let pool = Pool::new(key);
    let mut seen = Seen::default();
    for seed in 0..CONVERSATIONS {
        let mut dice = Dice(Xoshiro256PlusPlus::seed_from_u64(seed));
        let mut talk = Talk::new(&pool, seed, &mut dice);
        for _ in 0..STEPS {
            talk.step(&mut dice, &mut seen);
        }
        talk.look_at_everything(&mut seen);
    }
    seen
}

/// That it happened often enough to mean something.
fn assert_often(seen: &Seen, what: &[&str]) {
    for what in what {
        let times = seen.get(what).copied().unwrap_or(0);
        assert!(times >= 20, "{what}: {times} times; of all: {seen:#?}");
    }
}

const ALWAYS: [&str; 19] = [
    "Identity",
    "State",
    "Measured",
    "Reading",
    "Done",
    "Storage",
    "Nonce",
    "Locked",
    "WrongAnswer",
    "Offset",
    "Truncated",
    "UnknownRequest",
    "Period",
    "repeated",
    "spoilt",
    "power cycle",
    "StreamedReading",
    "StreamedSample",
    "flash takes nothing",
];

#[test]
fn an_instrument_without_a_key_is_what_the_model_is() {
    let seen = converse(FactoryKey::NotAsked);
    assert_often(&seen, &ALWAYS);
    assert_often(&seen, &["committed", "rolled back", "UntilPowerOff", "Piece", "NoCalibration", "OtherSerial"]);
    assert_often(&seen, &["Unusable", "NothingBefore", "StorageFailed", "power fails at a commit: old", "NotABlob"]);
    assert_often(&seen, &["power fails at a commit: new"]);
}

#[test]
fn an_instrument_that_holds_a_key_is_what_the_model_is() {
    let seen = converse(Pool::factory());
    assert_often(&seen, &ALWAYS);
    assert_often(&seen, &["committed", "rolled back", "Unsigned", "OtherSerial", "Unusable", "Piece"]);
}

#[test]
fn an_instrument_whose_key_is_spoilt_is_what_the_model_is_and_takes_nothing() {
    let seen = converse(FactoryKey::Spoilt);
    assert_often(&seen, &ALWAYS);
    assert_often(&seen, &["Unsigned", "OtherSerial", "NoCalibration"]);
    assert_eq!((seen.get("committed"), seen.get("Piece"), seen.get("UntilPowerOff")), (None, None, None));
}
