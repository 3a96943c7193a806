//! Lines to instruments: what a user may write for a port, and how each kind carries bytes.

mod qemu;
mod received;
mod serial;
mod tcp;

use crate::failure::Failure;
use firmware_core::IdentityRecord;
use firmware_sim::link::{Link, LinkError, Transport};
use firmware_sim::virtual_flash::VirtualFlash;
use firmware_sim::virtual_line::VirtualLine;
use std::io;
use std::path::PathBuf;
use std::str::FromStr;

/// A line of any kind, and the conversation over it.
pub type AnyLink = Link<Box<dyn Transport<Error = io::Error>>>;

/// Where an instrument is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Port {
    /// In this program.
    Sim,
    /// The image in an emulator, the one that `.ci/firmware` builds or another one.
    Qemu(Option<PathBuf>),
    /// At a socket.
    Tcp(String),
    /// At a serial port or a pseudo-terminal.
    Serial(PathBuf),
}

/// What to write for a port, for the commands' help.
pub const PORTS: &str = "serial port, as /dev/ttyUSB0 or COM3; tcp:HOST:PORT; or a pseudo-terminal, as /dev/pts/5";

impl FromStr for Port {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text.split_once(':') {
            Some(("tcp", address)) => Self::Tcp(address.to_owned()),
            Some(("qemu", image)) => Self::Qemu(Some(image.into())),
            _ if text == "sim" => Self::Sim,
            _ if text == "qemu" => Self::Qemu(None),
            _ => Self::Serial(text.into()),
        })
    }
}

impl Port {
    /// Whether an instrument is made anew for the occasion, with nothing in it that could be lost.
    pub const fn is_made_anew(&self) -> bool {
        matches!(self, Self::Sim | Self::Qemu(_))
    }

    /// Opens the line. One that is made anew becomes the sensor with this serial number.
    pub fn open(&self, serial: &str) -> Result<AnyLink, Failure> {
        let identity = IdentityRecord::new(serial);
        Ok(Link::new(match self {
            Self::Sim => Box::new(InMemory(VirtualLine::with(identity, VirtualFlash::new()))),
            Self::Qemu(image) => Box::new(qemu::Emulator::start(image.as_deref(), &identity)?),
            Self::Tcp(address) => Box::new(tcp::Socket::connect(address)?),
            Self::Serial(path) => Box::new(serial::Serial::open(path)?),
        }))
    }

    /// Opens the line to an instrument that is there already.
    pub fn connect(&self) -> Result<AnyLink, Failure> {
        if self.is_made_anew() {
            return Err(Failure::new("an instrument of `sim` or `qemu` ends with the command that began it")
                .help("start one that stays with `tempco device serve` and name its port, tcp:127.0.0.1:7000"));
        }
        self.open("")
    }
}

/// The instrument in this program.
struct InMemory(VirtualLine);

impl Transport for InMemory {
    type Error = io::Error;

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let Ok(()) = self.0.send(bytes);
        Ok(())
    }

    fn receive(&mut self) -> io::Result<Option<u8>> {
        let Ok(byte) = self.0.receive();
        Ok(byte)
    }
}

impl From<LinkError<io::Error>> for Failure {
    fn from(error: LinkError<io::Error>) -> Self {
        let help = match &error {
            LinkError::Line(_) => {
                "the other end hung up; plug the instrument in, or start `tempco device serve`, and try again"
            }
            LinkError::NoAnswer { .. } => {
                "check power, wiring (115200 baud, 8 bits, no parity) and that nobody else has the port open"
            }
            _ => return Self::new(error),
        };
        Self::new(error).help(help)
    }
}

#[cfg(test)]
mod tests {
    use super::Port;

    #[test]
    fn a_port_is_what_it_looks_like() {
        let port = |text: &str| -> Port {
            let Ok(port) = text.parse();
            port
        };
        assert_eq!(port("sim"), Port::Sim);
        assert_eq!(port("qemu"), Port::Qemu(None));
        assert_eq!(port("qemu:a/b.elf"), Port::Qemu(Some("a/b.elf".into())));
        assert_eq!(port("tcp:127.0.0.1:7000"), Port::Tcp("127.0.0.1:7000".to_owned()));
        assert_eq!(port("/dev/ttyUSB0"), Port::Serial("/dev/ttyUSB0".into()));
        assert_eq!(port("COM3"), Port::Serial("COM3".into()));
    }
}
