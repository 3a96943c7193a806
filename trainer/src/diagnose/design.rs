//! What to measure next: hypotheses, and the recording that would tell them apart.

mod distance;
mod hypothesis;
pub mod plan;
mod planned;
mod separation;

pub(super) use separation::separate;
