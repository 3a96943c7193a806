//! Least squares under a noise that is not white, and the noise that makes what was measured most likely.

mod gls;
mod variance_components;

pub(super) use gls::{Gls, Score, directions};
pub(super) use variance_components::Measured;
