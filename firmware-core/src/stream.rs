//! Measuring at a period, unasked.
//!
//! The counter's gate and the period are two clocks. A stream waits for a gate that closes a little later, up to half a
//! period, and goes on from there; without that the two would pass each other now and then and leave a hole.

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
    waited: bool,
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
        Ok(Self { what, sequence, period_us, last_us: time_us.wrapping_sub(period_us), waited: false, number: 0 })
    }

    /// Whether a message is due. A clock that was set back makes the time passed huge: due, and in step again.
    pub const fn is_due(&self, time_us: u64) -> bool {
        self.passed_us(time_us) >= self.period_us
    }

    /// Whether to wait a little longer for sensors that have nothing new.
    pub const fn waits(&mut self, time_us: u64) -> bool {
        self.waited = self.passed_us(time_us) < self.period_us + self.period_us / 2;
        self.waited
    }

    /// The number of the message that goes out now. Falling behind skips messages; they never pile up.
    pub const fn take(&mut self, time_us: u64) -> u32 {
        // On the grid of the period, unless that is out of reach or the sensors have a grid of their own.
        let keeps_step = self.passed_us(time_us) < 2 * self.period_us && !self.waited;
        self.last_us = if keeps_step { self.last_us.wrapping_add(self.period_us) } else { time_us };
        self.waited = false;
        let number = self.number;
        self.number = self.number.wrapping_add(1);
        number
    }

    const fn passed_us(&self, time_us: u64) -> u64 {
        time_us.wrapping_sub(self.last_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(period_ms: u32) -> Stream {
        Stream::new(Streamed::Readings, period_ms, 1, 5).expect("a period within limits")
    }

    fn due(stream: &mut Stream, time_us: u64) -> Option<u32> {
        stream.is_due(time_us).then(|| stream.take(time_us))
    }

    #[test]
    fn it_waits_half_a_period_for_the_sensors_and_goes_on_in_their_step() {
        let mut stream = stream(10);
        assert_eq!(due(&mut stream, 5), Some(0));
        assert!(stream.is_due(10_005) && stream.waits(10_005));
        assert!(stream.is_due(12_000) && stream.waits(12_000));
        assert_eq!(due(&mut stream, 13_000), Some(1));
        assert_eq!(due(&mut stream, 22_999), None);
        assert!(stream.is_due(23_000) && stream.waits(27_999) && !stream.waits(28_000));
        assert_eq!(due(&mut stream, 28_000), Some(2));
        assert_eq!(due(&mut stream, 33_000), Some(3), "without having waited, the grid holds");
    }

    #[test]
    fn it_is_due_at_once_and_then_once_a_period() {
        let mut stream = stream(10);
        let due = [5, 6, 10_004, 10_005, 10_006, 20_100, 30_004, 30_005].map(|time_us| due(&mut stream, time_us));
        assert_eq!(due, [Some(0), None, None, Some(1), None, Some(2), None, Some(3)]);
    }

    #[test]
    fn it_catches_up_without_a_burst_and_survives_a_clock_that_jumps() {
        let mut stream = stream(10);
        let due = [5, 95_000, 95_001, 105_000, 3, 4, 10_003].map(|time_us| due(&mut stream, time_us));
        assert_eq!(due, [Some(0), Some(1), None, Some(2), Some(3), None, Some(4)]);
    }

    #[test]
    fn two_whole_periods_late_is_out_of_step() {
        let mut stream = stream(10);
        let due = [5, 20_004, 20_006, 40_005, 40_006].map(|time_us| due(&mut stream, time_us));
        assert_eq!(due, [Some(0), Some(1), Some(2), Some(3), None], "less than that is made up for");
    }

    #[test]
    fn periods_out_of_bounds_are_refused_with_the_bounds() {
        for period_ms in [0, 9, 3_600_001, u32::MAX] {
            let refusal = Refusal::Period { shortest_ms: 10, longest_ms: 3_600_000 };
            assert_eq!(Stream::new(Streamed::Samples, period_ms, 1, 0).err(), Some(refusal));
        }
    }
}
