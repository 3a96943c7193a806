//! Microseconds since power-on, from the core's 24-bit timer.

use crate::registers::systick::{CSR, CVR, RVR};

/// The core's and all buses' clock.
pub const CLOCK_HZ: u32 = 16_000_000;

/// The timer counts every eighth tick of the processor's clock.
const TICKS_PER_US: u32 = CLOCK_HZ / 8 / 1_000_000;
/// One turn is eight seconds: it fits 24 bits, and erasing a sector, when the processor stands still, is shorter.
const SECONDS_PER_TURN: u32 = 8;
const TICKS_PER_TURN: u32 = SECONDS_PER_TURN * 1_000_000 * TICKS_PER_US;
const TURNED: u32 = 1 << 16;

/// Time since power-on.
pub struct Clock {
    turns: u64,
}

impl Clock {
    /// Starts at zero.
    pub fn start() -> Self {
        RVR.write(TICKS_PER_TURN - 1);
        CVR.write(0);
        // An eighth of the processor clock, interrupt (which only ends a sleep), run.
        CSR.write(0b011);
        Self { turns: 0 }
    }

    /// The time. To be asked at least once a turn, which the loop does: the timer ends its sleeps.
    pub fn now_us(&mut self) -> u64 {
        loop {
            let left = CVR.read();
            // Reading the flag clears it. If it turned, the value above may belong to either turn: look again.
            if CSR.read() & TURNED == 0 {
                let ticks = (TICKS_PER_TURN - 1).saturating_sub(left);
                return self.turns * u64::from(SECONDS_PER_TURN * 1_000_000) + u64::from(ticks / TICKS_PER_US);
            }
            self.turns += 1;
        }
    }
}
