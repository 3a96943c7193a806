//! The microcontroller's image in QEMU, and the line to it.

use crate::workspace::{root, text};
use firmware_sim::link::Transport;
use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// How long QEMU may take to start on a busy machine, in looks of [`LOOK`].
const LOOKS: usize = 600;
const LOOK: Duration = Duration::from_millis(50);

/// More bytes than a slot uses.
const ERASED: usize = 2048;

/// A running microcontroller; dropping it switches it off.
pub struct Microcontroller {
    emulator: Child,
    line: TcpStream,
    received: Vec<u8>,
    // Holds the flash contents that QEMU loads.
    _folder: TempDir,
}

impl Microcontroller {
    /// Starts the image with these flash contents; empty ones are left erased. `patience` is how
    /// long its line waits for a byte.
    ///
    /// # Panics
    /// With an instruction, if the image or QEMU is missing.
    #[must_use]
    pub fn start(identity: &[u8], calibration: &[u8], patience: Duration) -> Self {
        Self::start_image(&image(), identity, calibration, patience)
    }

    /// The same with the variant of the image that checks signatures.
    ///
    /// # Panics
    /// As [`Microcontroller::start`].
    #[must_use]
    pub fn start_with_signatures(identity: &[u8], patience: Duration) -> Self {
        let mut name = image().into_os_string();
        name.push("-signatures");
        Self::start_image(&present(name.into()), identity, &[], patience)
    }

    fn start_image(image: &Path, identity: &[u8], calibration: &[u8], patience: Duration) -> Self {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let port = listener.local_addr().expect("a bound port").port();
        let mut command = Command::new("qemu-system-arm");
        command
            .args(["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "chardev:line"])
            .args(["-chardev", &format!("socket,id=line,host=127.0.0.1,port={port},nodelay=on")])
            .arg("-kernel")
            .arg(image);
        for (region, bytes) in [("IDENTITY", identity), ("CALIBRATION", calibration)] {
            if !bytes.is_empty() {
                // QEMU's flash is zero where nobody wrote; a programmer leaves it erased.
                let erased = bytes.iter().copied().chain(std::iter::repeat(0xFF)).take(ERASED).collect::<Vec<_>>();
                command.args(["-device", &loader(&folder.path().join(region), &erased, &origin(region))]);
            }
        }
        let mut emulator = command.stdin(Stdio::null()).spawn().unwrap_or_else(|error| {
            panic!("qemu-system-arm does not start ({error}); install it, on Debian: apt-get install qemu-system-arm")
        });
        let line = accept(&listener, &mut emulator);
        line.set_nodelay(true).expect("a socket's option");
        line.set_read_timeout(Some(patience)).expect("a socket's option");
        Self { emulator, line, received: Vec::new(), _folder: folder }
    }
}

/// The image to test.
fn image() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let built = || target.join("thumbv7em-none-eabihf/firmware/firmware");
    let image = std::env::var_os("TEMPCO_FIRMWARE_ELF").map_or_else(built, PathBuf::from);
    present(image)
}

fn present(image: PathBuf) -> PathBuf {
    assert!(image.is_file(), "no image at {}; build it with .ci/firmware", image.display());
    image
}

/// Where `memory.x` puts a region of the flash.
fn origin(region: &str) -> String {
    let memory = text("memory.x");
    let line = memory.lines().find(|line| line.trim_start().starts_with(region));
    let origin = line.and_then(|line| line.split(['=', ',']).nth(1));
    origin.unwrap_or_else(|| panic!("memory.x names no region {region}")).trim().to_owned()
}

/// QEMU's option that puts bytes into flash.
fn loader(file: &Path, bytes: &[u8], address: &str) -> String {
    fs::write(file, bytes).expect("the temporary folder is writable");
    format!("loader,file={},addr={address},force-raw=on", file.display())
}

fn accept(listener: &TcpListener, emulator: &mut Child) -> TcpStream {
    listener.set_nonblocking(true).expect("a socket's option");
    for _ in 0..LOOKS {
        if let Ok((line, _)) = listener.accept() {
            line.set_nonblocking(false).expect("a socket's option");
            return line;
        }
        if let Ok(Some(status)) = emulator.try_wait() {
            panic!("qemu-system-arm ended at once, {status}; its message stands above");
        }
        std::thread::sleep(LOOK);
    }
    let _ = emulator.kill();
    panic!("qemu-system-arm did not connect within {} s", LOOKS as f64 * LOOK.as_secs_f64());
}

impl Drop for Microcontroller {
    fn drop(&mut self) {
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
    }
}

impl Transport for Microcontroller {
    type Error = std::io::Error;

    fn send(&mut self, bytes: &[u8]) -> Result<(), std::io::Error> {
        self.line.write_all(bytes)
    }

    fn receive(&mut self) -> Result<Option<u8>, std::io::Error> {
        if self.received.is_empty() {
            let mut buffer = [0; 512];
            match self.line.read(&mut buffer) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => self.received.extend(buffer[..count].iter().rev()),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(self.received.pop())
    }
}
