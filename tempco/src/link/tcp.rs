//! An instrument at a socket: `tempco device serve`, or a serial port that a computer elsewhere offers.

use super::received::next_byte;
use crate::failure::Failure;
use firmware_sim::link::Transport;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Longer than the instrument takes to answer.
const PATIENCE: Duration = Duration::from_millis(500);

pub struct Socket {
    stream: TcpStream,
    received: Vec<u8>,
}

impl Socket {
    pub fn connect(address: &str) -> Result<Self, Failure> {
        let stream = TcpStream::connect(address).map_err(|error| {
            Failure::new(format_args!("tcp:{address}: {error}"))
                .help("write tcp:HOST:PORT; `tempco device serve` starts a virtual instrument at tcp:127.0.0.1:7000")
        })?;
        Self::over(stream, PATIENCE).map_err(|error| Failure::new(format_args!("tcp:{address}: {error}")))
    }

    pub fn over(stream: TcpStream, patience: Duration) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(patience))?;
        Ok(Self { stream, received: Vec::new() })
    }
}

impl Transport for Socket {
    type Error = io::Error;

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.stream.write_all(bytes)
    }

    fn receive(&mut self) -> io::Result<Option<u8>> {
        next_byte(&mut self.received, |buffer| self.stream.read(buffer))
    }
}
