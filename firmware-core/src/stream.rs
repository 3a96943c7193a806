//! Measuring at a period, unasked.

use protocol::{Refusal, Streamed};

const SHORTEST_MS: u32 = 10;
const LONGEST_MS: u32 = 3_600_000;

/// A stream under way.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    /// What it carries.
    pub what: Streamed,
    /// The request that began it; its messages bear the same number.
    pub sequence: u16,
    period_us: u64,
    last_us: u64,
    number: u32,
}

impl Stream {
    /// A stream whose first message is due at once.
    ///
    /// # Errors
    /// [`Refusal::Period`].
    pub fn new(what: Streamed, period_ms: u32, sequence: u16, time_us: u64) -> Result<Self, Refusal> {
        if !(SHORTEST_MS..=LONGEST_MS).contains(&period_ms) {
            return Err(Refusal::Period { shortest_ms: SHORTEST_MS, longest_ms: LONGEST_MS });
        }
        let period_us = u64::from(period_ms) * 1000;
        Ok(Self { what, sequence, period_us, last_us: time_us.wrapping_sub(period_us), number: 0 })
    }

    /// The number of the message that is due now, if one is. Falling behind skips messages; they never pile up.
    pub fn due(&mut self, time_us: u64) -> Option<u32> {
        let passed_us = time_us.wrapping_sub(self.last_us);
        // A clock that was set back makes the difference huge: due, and in step again.
        if passed_us < self.period_us {
            return None;
        }
        // On the grid of the period, unless that is out of reach.
        let next_us = self.last_us.wrapping_add(self.period_us);
        self.last_us = if passed_us < 2 * self.period_us { next_us } else { time_us };
        let number = self.number;
        self.number = self.number.wrapping_add(1);
        Some(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(period_ms: u32) -> Stream {
        Stream::new(Streamed::Readings, period_ms, 1, 5).expect("a period within limits")
    }

    #[test]
    fn it_is_due_at_once_and_then_once_a_period() {
        let mut stream = stream(10);
        let due = [5, 6, 10_004, 10_005, 10_006, 20_100, 30_004, 30_005].map(|time_us| stream.due(time_us));
        assert_eq!(due, [Some(0), None, None, Some(1), None, Some(2), None, Some(3)]);
    }

    #[test]
    fn it_catches_up_without_a_burst_and_survives_a_clock_that_jumps() {
        let mut stream = stream(10);
        let due = [5, 95_000, 95_001, 105_000, 3, 4, 10_003].map(|time_us| stream.due(time_us));
        assert_eq!(due, [Some(0), Some(1), None, Some(2), Some(3), None, Some(4)]);
    }

    #[test]
    fn periods_out_of_bounds_are_refused_with_the_bounds() {
        for period_ms in [0, 9, 3_600_001, u32::MAX] {
            let refusal = Refusal::Period { shortest_ms: 10, longest_ms: 3_600_000 };
            assert_eq!(Stream::new(Streamed::Samples, period_ms, 1, 0).err(), Some(refusal));
        }
    }
}
