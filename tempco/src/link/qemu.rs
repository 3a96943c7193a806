//! The microcontroller's image in QEMU, started for the occasion.

use super::tcp::Socket;
use crate::failure::Failure;
use crate::region;
use firmware_core::IdentityRecord;
use firmware_sim::link::Transport;
use std::io;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Where `.ci/firmware` puts the image.
const IMAGE: &str = "target/thumbv7em-none-eabihf/firmware/firmware";
/// On a busy machine an answer may take seconds; a broken image takes for ever.
const PATIENCE: Duration = Duration::from_secs(5);
/// How often, and how long each time, to look whether QEMU has connected.
const LOOKS: usize = 400;
const LOOK: Duration = Duration::from_millis(50);

/// A running microcontroller; dropping it switches it off.
pub struct Emulator {
    process: Child,
    line: Socket,
    // Holds what QEMU loads.
    _folder: TempDir,
}

impl Emulator {
    pub fn start(image: Option<&Path>, identity: &IdentityRecord) -> Result<Self, Failure> {
        let image = image.unwrap_or(Path::new(IMAGE));
        if !image.is_file() {
            return Err(Failure::new(format_args!("{}: no such image", image.display()))
                .help("build it with .ci/firmware in the project's folder, or name one: --on qemu:IMAGE"));
        }
        let io = |error: io::Error| Failure::new(format_args!("QEMU: {error}"));
        let folder = tempfile::tempdir().map_err(io)?;
        let record = folder.path().join("identity.bin");
        std::fs::write(&record, identity.to_bytes()).map_err(io)?;
        let (address, _) = region::identity()?;
        let listener = TcpListener::bind("127.0.0.1:0").map_err(io)?;
        let port = listener.local_addr().map_err(io)?.port();
        let process = Command::new("qemu-system-arm")
            .args(["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "chardev:line"])
            .args(["-chardev", &format!("socket,id=line,host=127.0.0.1,port={port},nodelay=on")])
            .args(["-device", &format!("loader,file={},addr={address},force-raw=on", record.display())])
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .spawn()
            .map_err(|error| {
                Failure::new(format_args!("qemu-system-arm does not start: {error}"))
                    .help("install it; on Debian: apt-get install qemu-system-arm")
            })?;
        connected(process, &listener, folder)
    }
}

fn connected(mut process: Child, listener: &TcpListener, folder: TempDir) -> Result<Emulator, Failure> {
    let io = |error: io::Error| Failure::new(format_args!("QEMU: {error}"));
    listener.set_nonblocking(true).map_err(io)?;
    for _ in 0..LOOKS {
        if let Ok((stream, _)) = listener.accept() {
            stream.set_nonblocking(false).map_err(io)?;
            let line = Socket::over(stream, PATIENCE).map_err(io)?;
            return Ok(Emulator { process, line, _folder: folder });
        }
        if let Ok(Some(status)) = process.try_wait() {
            return Err(Failure::new(format_args!("QEMU ended at once, {status}; its message stands above")));
        }
        std::thread::sleep(LOOK);
    }
    let _ = process.kill();
    let _ = process.wait();
    Err(Failure::new(format_args!("QEMU did not connect within {} s", LOOKS as f64 * LOOK.as_secs_f64())))
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Transport for Emulator {
    type Error = io::Error;

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.line.send(bytes)
    }

    fn receive(&mut self) -> io::Result<Option<u8>> {
        self.line.receive()
    }
}
