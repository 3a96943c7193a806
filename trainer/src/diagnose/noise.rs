//! What noise looks like, and how it is taken out of the way.
//!
//! A residual is not white: flicker and random walk make neighbours alike, a table error shifts a position, a
//! soak that is not quite like the last one shifts a node, a mounting shifts a run in proportion to the
//! acceleration across the input axis, a start shifts a run. An effect is judged by what it explains beyond all
//! that. The noise is a sum of states that a Kalman filter tracks; its innovations are white, and every column
//! that goes through the same filter can be compared by plain least squares.

mod components;
mod initial_state;
mod kalman;
mod likelihood;
mod observation;
#[cfg(test)]
mod other_filter;
mod reported;

pub(super) use components::{Component, NoiseModel};
pub(super) use initial_state::{InitialStates, Shares};
pub(super) use likelihood::{Whitening, deviance};
pub(super) use reported::{from_reported, reported};
