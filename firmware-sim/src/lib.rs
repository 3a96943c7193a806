//! The instrument that exists only in memory: a laboratory and an accelerometer for those who have neither.
//!
//! A [`scenario::Scenario`] says what the laboratory does, [`simulation::simulate`] does it, and a [`recording::Recording`]
//! is what it measured.
//!
//! ```
//! use std::ops::ControlFlow;
//! use firmware_sim::{scenario::Scenario, simulation};
//!
//! let scenario = Scenario::preset("clean").expect("a built-in scenario");
//! let recording = simulation::simulate(&scenario, 1, &mut |_| ControlFlow::Continue(()))?;
//! let mut csv = Vec::new();
//! recording.write_csv(&mut csv)?;
//! assert!(csv.starts_with(b"run,kind,time_s,temperature_c,delta_f_hz,reference_g"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod blind;
pub mod limit;
pub mod link;
pub mod recording;
pub mod scenario;
pub mod seal;
pub mod simulation;
pub mod twin;
pub mod virtual_bench;
pub mod virtual_counter;
pub mod virtual_fault;
pub mod virtual_faulty_line;
pub mod virtual_flash;
pub mod virtual_instrument;
pub mod virtual_line;
pub mod virtual_thermometer;
