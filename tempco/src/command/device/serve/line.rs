//! The instrument's end of a line: a socket that one client at a time may use, or a pseudo-terminal.

use crate::failure::Failure;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

/// How long the instrument sleeps at most between two looks at its line.
const NAP: Duration = Duration::from_millis(5);

/// A client that takes nothing for this long has gone.
const STUCK: Duration = Duration::from_secs(1);

/// Where clients come.
pub enum Listener {
    Socket {
        listener: TcpListener,
        client: Option<TcpStream>,
    },
    #[cfg(unix)]
    Terminal {
        master: Box<serialport::TTYPort>,
        name: String,
    },
}

impl Listener {
    pub fn socket(address: &str) -> Result<Self, Failure> {
        let listener = TcpListener::bind(address).map_err(|error| {
            Failure::new(format_args!("{address}: {error}"))
                .help("choose another port: --tcp 127.0.0.1:0 takes any free one")
        })?;
        listener.set_nonblocking(true).map_err(|error| Failure::new(format_args!("{address}: {error}")))?;
        Ok(Self::Socket { listener, client: None })
    }

    #[cfg(unix)]
    pub fn terminal() -> Result<Self, Failure> {
        use serialport::SerialPort;
        // The far end is closed again: whoever opens it as a serial port wants it for himself.
        let (mut master, far_end) = serialport::TTYPort::pair().map_err(Failure::new)?;
        let name = far_end.name().unwrap_or_default();
        master.set_timeout(NAP).map_err(Failure::new)?;
        Ok(Self::Terminal { master: Box::new(master), name })
    }

    #[cfg(not(unix))]
    pub fn terminal() -> Result<Self, Failure> {
        Err(Failure::new("this system has no pseudo-terminals")
            .help("leave --pty out: the instrument listens at a socket"))
    }

    /// What clients call it.
    pub fn name(&self) -> String {
        match self {
            Self::Socket { listener, .. } => {
                listener.local_addr().map_or_else(|_| "a socket".to_owned(), |address| format!("tcp:{address}"))
            }
            #[cfg(unix)]
            Self::Terminal { name, .. } => name.clone(),
        }
    }

    /// What arrived; nothing after a short wait.
    pub fn receive(&mut self) -> Vec<u8> {
        let mut buffer = [0; 512];
        let read = match self {
            Self::Socket { listener, client } => {
                if let Ok((stream, _)) = listener.accept() {
                    *client = prepared(stream);
                }
                let Some(stream) = client else {
                    std::thread::sleep(NAP);
                    return Vec::new();
                };
                stream.read(&mut buffer)
            }
            #[cfg(unix)]
            Self::Terminal { master, .. } => master.read(&mut buffer),
        };
        match read {
            Ok(0) => self.hang_up(),
            Ok(count) => return buffer[..count].to_vec(),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => self.hang_up(),
        }
        Vec::new()
    }

    /// Sends; what nobody takes is lost, as on any line.
    pub fn send(&mut self, bytes: &[u8]) {
        let sent = match self {
            Self::Socket { client: Some(stream), .. } => stream.write_all(bytes),
            Self::Socket { client: None, .. } => Ok(()),
            #[cfg(unix)]
            Self::Terminal { master, .. } => {
                let _ = master.write_all(bytes);
                Ok(())
            }
        };
        if sent.is_err() {
            self.hang_up();
        }
    }

    fn hang_up(&mut self) {
        match self {
            Self::Socket { client, .. } => *client = None,
            // Nobody has it open; it stays until somebody does.
            #[cfg(unix)]
            Self::Terminal { .. } => std::thread::sleep(NAP),
        }
    }
}

fn prepared(stream: TcpStream) -> Option<TcpStream> {
    stream.set_nonblocking(false).ok()?;
    stream.set_nodelay(true).ok()?;
    stream.set_read_timeout(Some(NAP)).ok()?;
    stream.set_write_timeout(Some(STUCK)).ok()?;
    Some(stream)
}
