//! `tempco device serve`: an instrument for those who have none.

mod line;

use self::line::Listener;
use super::provision::identity;
use super::watch::interrupted;
use crate::command::simulate::{scenario, simulate};
use crate::data::seeds;
use crate::failure::{Answer, Failure};
use crate::output::{Kind, Output};
use crate::terminal::say;
use clap::Args;
use firmware_sim::link::Transport;
use firmware_sim::virtual_bench::VirtualBench;
use firmware_sim::virtual_flash::VirtualFlash;
use firmware_sim::virtual_line::VirtualLine;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Runs a virtual instrument that measures the physics twin, and answers at a socket or a pseudo-terminal.
///
/// Its program and drivers are those of the microcontroller, its parts are modelled register by register, its time is
/// this computer's. Ctrl-C switches it off.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco device serve --flash instrument.flash\n          tempco device monitor tcp:127.0.0.1:7000"
)]
pub struct Serve {
    /// Listens at this address; port 0 takes any free one
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:7000", conflicts_with = "pty")]
    tcp: String,

    /// Listens at a new pseudo-terminal instead, which programs open like a serial port
    #[arg(long)]
    pty: bool,

    /// Serial number
    #[arg(long, value_name = "SN", default_value = "VIRTUAL-1")]
    serial: String,

    /// Takes only calibrations signed by the owner of this public key
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,

    /// Keeps the contents of its flash in this file, across power-off
    #[arg(long, value_name = "FILE")]
    flash: Option<PathBuf>,

    /// What the twin goes through, over and over: a built-in scenario or a scenario file (`tempco simulate` lists them)
    #[arg(long, default_value = "clean")]
    scenario: String,

    /// Seed of every random number, up to 2⁶³ − 1
    #[arg(long, default_value_t = 1, value_parser = seeds())]
    seed: u64,
}

impl Serve {
    pub fn run(&self) -> Result<Answer, Failure> {
        let kept_in = self.flash.as_deref().map(|path| Output::own(path, Kind::Flash));
        kept_in.as_ref().map_or(Ok(()), Output::check)?;
        let enough = interrupted()?;
        let identity = identity(&self.serial, self.key.as_ref())?;
        let flash = self.flash.as_deref().map_or_else(|| Ok(VirtualFlash::new()), read)?;
        let mut bench = VirtualBench::new(simulate(&scenario(&self.scenario)?, self.seed)?);
        let mut instrument = VirtualLine::with(identity, flash);
        let mut listener = if self.pty { Listener::terminal()? } else { Listener::socket(&self.tcp)? };
        say!("Instrument {} at {}; Ctrl-C switches it off", self.serial, listener.name())?;
        let (clock, mut kept) = (Clock::start(), instrument.flash_mut().steps());
        while !enough.load(Ordering::Relaxed) {
            let time_us = clock.now_us();
            let sensors = instrument.device_mut().sensors_mut();
            bench.advance(time_us, sensors.counter.device_mut(), sensors.thermometer.bus_mut());
            instrument.set_time_us(time_us);
            let Ok(()) = instrument.send(&listener.receive());
            let mut answer = Vec::new();
            while let Ok(Some(byte)) = instrument.receive() {
                answer.push(byte);
            }
            // Before the answer, which may say that it is kept for good.
            if let Some(file) = kept_in.as_ref().filter(|_| instrument.flash_mut().steps() != kept) {
                kept = instrument.flash_mut().steps();
                file.write(instrument.flash_mut().bytes())?;
            }
            listener.send(&answer);
        }
        Ok(Answer::Yes)
    }
}

/// What an earlier instrument left; a file that is not there yet is an erased flash.
fn read(path: &Path) -> Result<VirtualFlash, Failure> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(VirtualFlash::holding(&bytes)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(VirtualFlash::new()),
        Err(error) => Err(Failure::io(path, &error)),
    }
}

/// Time since power-on.
struct Clock(Instant);

#[expect(clippy::disallowed_methods, reason = "this instrument's time is this computer's")]
impl Clock {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn now_us(&self) -> u64 {
        u64::try_from(self.0.elapsed().as_micros()).unwrap_or(u64::MAX)
    }
}
