//! An instrument at a serial port or a pseudo-terminal.

use super::received::next_byte;
use crate::failure::Failure;
use firmware_sim::link::Transport;
use serialport::SerialPort;
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

const BAUD: u32 = 115_200;
/// Longer than the instrument takes to answer.
const PATIENCE: Duration = Duration::from_millis(500);

pub struct Serial {
    port: Box<dyn SerialPort>,
    received: Vec<u8>,
}

impl Serial {
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let port = serialport::new(path.to_string_lossy(), BAUD)
            .timeout(PATIENCE)
            .open()
            .map_err(|error| Failure::new(format_args!("{}: {error}", path.display())).help(present()))?;
        Ok(Self { port, received: Vec::new() })
    }
}

/// What could have been meant.
fn present() -> String {
    let names: Vec<String> =
        serialport::available_ports().unwrap_or_default().into_iter().map(|port| port.port_name).collect();
    match names.as_slice() {
        [] => "this computer has no serial port; `tempco device serve` starts a virtual instrument instead".to_owned(),
        names => format!("serial ports here: {}; or write tcp:HOST:PORT", names.join(", ")),
    }
}

impl Transport for Serial {
    type Error = io::Error;

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write_all(bytes)
    }

    fn receive(&mut self) -> io::Result<Option<u8>> {
        next_byte(&mut self.received, |buffer| self.port.read(buffer))
    }
}
