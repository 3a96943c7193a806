//! The timer that ends a sleep. It runs once: QEMU's fires without end otherwise.

use crate::clock::CLOCK_HZ;
use crate::registers::tim2::{ARR, CR1, DIER, EGR, PSC, SR};

const RUN: u32 = 1 << 0;
/// Only the end of the time is an event, not the update that begins it.
const END_ONLY: u32 = 1 << 2;
const ONCE: u32 = 1 << 3;

/// Lets the interrupt become pending after this time.
pub fn start(after_us: u32) {
    PSC.write(CLOCK_HZ / 1_000_000 - 1);
    ARR.write(after_us);
    DIER.write(1);
    CR1.write(END_ONLY);
    EGR.write(1);
    CR1.write(END_ONLY | ONCE | RUN);
}

/// Whatever it was doing, it is over.
pub fn stop() {
    CR1.write(0);
    SR.write(0);
}
