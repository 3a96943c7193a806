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
        Self::start_with(&image("firmware"), &[], identity, calibration, patience)
    }

    /// The same with the variant of the image that checks signatures.
    ///
    /// # Panics
    /// As [`Microcontroller::start`].
    #[must_use]
    pub fn start_with_signatures(identity: &[u8], patience: Duration) -> Self {
        Self::start_with(&image("firmware-signatures"), &[], identity, &[], patience)
    }

    /// Starts the image that logs; [`Microcontroller::end`] gives what it logged.
    ///
    /// # Panics
    /// As [`Microcontroller::start`].
    #[must_use]
    pub fn start_logging(identity: &[u8], calibration: &[u8], patience: Duration) -> Self {
        let semihosting = ["-semihosting-config", "enable=on,target=native"];
        Self::start_with(&image("firmware-logging"), &semihosting, identity, calibration, patience)
    }

    /// Starts the image that ships in a memory full of a pattern; [`Stack::depth`] sees how far down it was used.
    ///
    /// # Panics
    /// As [`Microcontroller::start`].
    #[must_use]
    pub fn start_painted(identity: &[u8], calibration: &[u8], patience: Duration) -> (Self, Stack) {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let paint = loader(&folder.path().join("paint"), &[PAINT; RAM_BYTES], &origin("RAM"));
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let monitor = format!("tcp:{}", listener.local_addr().expect("a bound port"));
        let options = ["-monitor", &monitor, "-device", &paint];
        let mut started = Self::start_with(&image("firmware"), &options, identity, calibration, patience);
        let monitor = accept(&listener, &mut started.emulator);
        (started, Stack { monitor, folder })
    }

    /// Switches it off; returns what it logged, encoded.
    ///
    /// # Panics
    /// If the emulator's output can't be read.
    #[must_use]
    pub fn end(mut self) -> Vec<u8> {
        let _ = self.emulator.kill();
        let mut log = Vec::new();
        self.emulator.stdout.take().expect("a pipe").read_to_end(&mut log).expect("a readable pipe");
        log
    }

    fn start_with(image: &Path, options: &[&str], identity: &[u8], calibration: &[u8], patience: Duration) -> Self {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let port = listener.local_addr().expect("a bound port").port();
        let mut command = Command::new("qemu-system-arm");
        command
            .args(["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "chardev:line"])
            .args(["-chardev", &format!("socket,id=line,host=127.0.0.1,port={port},nodelay=on")])
            .args(options)
            .arg("-kernel")
            .arg(image);
        for (region, bytes) in [("IDENTITY", identity), ("CALIBRATION", calibration)] {
            if !bytes.is_empty() {
                // QEMU's flash is zero where nobody wrote; a programmer leaves it erased.
                let erased = bytes.iter().copied().chain(std::iter::repeat(0xFF)).take(ERASED).collect::<Vec<_>>();
                command.args(["-device", &loader(&folder.path().join(region), &erased, &origin(region))]);
            }
        }
        let mut emulator = command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().unwrap_or_else(|error| {
            panic!("qemu-system-arm does not start ({error}); install it, on Debian: apt-get install qemu-system-arm")
        });
        let line = accept(&listener, &mut emulator);
        line.set_nodelay(true).expect("a socket's option");
        line.set_read_timeout(Some(patience)).expect("a socket's option");
        Self { emulator, line, received: Vec::new(), _folder: folder }
    }
}

/// What memory is full of before the image starts.
const PAINT: u8 = 0xA5;
const RAM_BYTES: usize = 128 * 1024;
/// More than any array that a function leaves untouched.
const UNTOUCHED: usize = 8192;

/// The memory of a running microcontroller, seen from the emulator.
pub struct Stack {
    monitor: TcpStream,
    folder: TempDir,
}

impl Stack {
    /// Bytes of stack that have been used since the start.
    ///
    /// # Panics
    /// If the emulator doesn't give its memory away.
    pub fn depth(&mut self) -> usize {
        let file = self.folder.path().join("memory");
        // Quoted, or the slash divides the number before it.
        let command = format!("pmemsave {} {RAM_BYTES} \"{}\"\n", origin("RAM"), file.display());
        self.monitor.write_all(command.as_bytes()).expect("the emulator listens");
        let saved = || fs::read(&file).ok().filter(|memory| memory.len() == RAM_BYTES);
        let memory = (0..LOOKS).find_map(|_| {
            std::thread::sleep(LOOK);
            saved()
        });
        let memory = memory.expect("the emulator saves its memory");
        let from_top = memory.rchunks(UNTOUCHED).position(|piece| piece.iter().all(|byte| *byte == PAINT));
        let used = &memory[RAM_BYTES - UNTOUCHED * from_top.expect("memory that was never used")..];
        used.len() - used.iter().take_while(|byte| **byte == PAINT).count()
    }
}

/// An image that `.ci/firmware` built: the one that ships, or the one that logs.
///
/// # Panics
/// With an instruction, if it is missing.
#[must_use]
pub fn image(name: &str) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let image = target.join("thumbv7em-none-eabihf/firmware").join(name);
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
