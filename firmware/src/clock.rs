//! Microseconds since power-on, from the core's 24-bit timer.

use crate::board::CLOCK_HZ;
use crate::board::systick::{CSR, CVR, RVR};

const TICKS_PER_US: u32 = CLOCK_HZ / 1_000_000;
/// One turn is a second: it fits 24 bits, and every sleep and every wait for a peripheral is shorter.
const TICKS_PER_TURN: u32 = CLOCK_HZ;
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
        // Processor clock, interrupt (which only ends a sleep), run.
        CSR.write(0b111);
        Self { turns: 0 }
    }

    /// The time. To be asked at least once a second, which the loop does: the timer ends its sleeps.
    pub fn now_us(&mut self) -> u64 {
        loop {
            let left = CVR.read();
            // Reading the flag clears it. If it turned, the value above may belong to either turn: look again.
            if CSR.read() & TURNED == 0 {
                let ticks = (TICKS_PER_TURN - 1).saturating_sub(left);
                return self.turns * 1_000_000 + u64::from(ticks / TICKS_PER_US);
            }
            self.turns += 1;
        }
    }
}
