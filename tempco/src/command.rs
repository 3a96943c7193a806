//! One verb, one file.

pub mod add;
pub mod change;
pub mod compare;
pub mod demo;
pub mod device;
pub mod diagnose;
pub mod effects;
#[cfg(test)]
mod example;
pub mod export;
pub mod flash;
pub mod inspect;
pub mod plan;
pub mod remove;
pub mod reproduce;
pub mod reveal;
pub mod simulate;
pub mod train;
pub mod verify;
