//! Files that appear whole or not at all: written beside their place, synced, and then put there in one step.
//!
//! A program can be killed at any moment, and then nothing of it runs any more to tidy up. So the file in the making has
//! no name at all where the system has such files (`O_TMPFILE` of Linux): it ends with its process. A name that is free it
//! gets in one step (`linkat`). No call puts it over a name that is taken: there it gets a name `.tempco-….part` and is
//! renamed at once, two calls with nothing between. Elsewhere it has that name from the start. Whoever writes into the
//! folder next removes what a killed process left; a lock on the file tells it from one that is still in the making.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

const PREFIX: &str = ".tempco-";
const SUFFIX: &str = ".part";
const LETTERS: usize = 8;

/// Who may read a new file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Readers {
    /// Whoever the user lets read files.
    All,
    /// The owner alone, from the first moment on.
    Owner,
}

/// What is written and not yet at its place.
pub enum Draft {
    /// Written and synced.
    File { target: PathBuf, body: Body },
    /// For a pipe or a device: there is nothing beside it.
    Stream { target: PathBuf, bytes: Vec<u8> },
}

/// A file that nobody sees.
pub enum Body {
    /// Ends with this process.
    #[cfg(target_os = "linux")]
    Nameless(File),
    Named(NamedTempFile),
}

impl Draft {
    /// Writes the bytes where nobody sees them.
    pub fn of(path: &Path, bytes: &[u8], readers: Readers) -> io::Result<Self> {
        let old = std::fs::metadata(path).ok();
        if old.as_ref().is_some_and(|old| !old.is_file()) {
            return Ok(Self::Stream { target: path.to_owned(), bytes: bytes.to_owned() });
        }
        // Through a link to the file that it names: the link stays.
        let target = if old.is_some() { path.canonicalize()? } else { path.to_owned() };
        let body = Body::new(folder(&target), readers)?;
        let mut file = body.file();
        file.write_all(bytes)?;
        if let Some(old) = old {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        Ok(Self::File { target, body })
    }

    /// Puts it at its place, over what is there.
    pub fn place(self) -> io::Result<()> {
        let (target, body) = match self {
            Self::File { target, body } => (target, body),
            Self::Stream { target, bytes } => return OpenOptions::new().write(true).open(target)?.write_all(&bytes),
        };
        match body {
            #[cfg(target_os = "linux")]
            Body::Nameless(file) => match link(&file, &target) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    let _ = file.try_lock();
                    let named = named(folder(&target), |name| link(&file, name))?;
                    named.persist(&target).map_err(|error| error.error)?;
                }
                done => done?,
            },
            Body::Named(file) => drop(file.persist(&target).map_err(|error| error.error)?),
        }
        sync_folder(&target);
        Ok(())
    }

    /// Puts it at its place, where nothing may be yet.
    pub fn place_new(self) -> io::Result<()> {
        let Self::File { target, body } = self else { return Err(io::ErrorKind::AlreadyExists.into()) };
        match body {
            #[cfg(target_os = "linux")]
            Body::Nameless(file) => link(&file, &target)?,
            Body::Named(file) => drop(file.persist_noclobber(&target).map_err(|error| error.error)?),
        }
        sync_folder(&target);
        Ok(())
    }
}

impl Body {
    fn new(folder: &Path, readers: Readers) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(file) = nameless(folder, readers) {
            return Ok(Self::Nameless(file));
        }
        loop {
            let file = named(folder, |path| options(readers).create_new(true).open(path))?;
            // Between its beginning and its lock somebody may have taken it for a dead one's, and removed it.
            let _ = file.as_file().try_lock();
            if file.path().exists() {
                return Ok(Self::Named(file));
            }
        }
    }

    fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => file,
            Self::Named(file) => file.as_file(),
        }
    }
}

fn options(readers: Readers) -> OpenOptions {
    let mut options = OpenOptions::new();
    options.write(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, if readers == Readers::Owner { 0o600 } else { 0o666 });
    #[cfg(not(unix))]
    let _ = readers;
    options
}

/// A file without a name that can still get one; none where the file system has no such files.
#[cfg(target_os = "linux")]
fn nameless(folder: &Path, readers: Readers) -> Option<File> {
    use std::os::unix::fs::OpenOptionsExt;
    let file = options(readers).custom_flags(rustix::fs::OFlags::TMPFILE.bits().cast_signed()).open(folder).ok()?;
    handle(&file).exists().then_some(file)
}

/// Gives a file a name that is free.
#[cfg(target_os = "linux")]
fn link(file: &File, path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    Ok(linkat(CWD, handle(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
}

/// Where the system shows an open file.
#[cfg(target_os = "linux")]
fn handle(file: &File) -> PathBuf {
    use std::os::fd::AsRawFd;
    format!("/proc/self/fd/{}", file.as_raw_fd()).into()
}

/// Makes something of a name that nobody has; it goes again unless it is renamed.
fn named<F>(folder: &Path, make: impl FnMut(&Path) -> io::Result<F>) -> io::Result<NamedTempFile<F>> {
    Builder::new().prefix(PREFIX).suffix(SUFFIX).rand_bytes(LETTERS).make_in(folder, make)
}

/// Removes what killed processes left in the folder of a file.
pub fn sweep(path: &Path) {
    let is_ours = |name: &str| {
        let letters = name.strip_prefix(PREFIX).and_then(|rest| rest.strip_suffix(SUFFIX));
        letters.is_some_and(|letters| letters.len() == LETTERS && letters.bytes().all(|b| b.is_ascii_alphanumeric()))
    };
    for entry in folder(path).read_dir().into_iter().flatten().flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && entry.file_name().to_str().is_some_and(is_ours) {
            let file = File::open(entry.path());
            if file.as_ref().is_ok_and(|file| file.try_lock().is_ok()) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

/// Whether a file can be made there at all: better known before the work than after it.
pub fn probe(path: &Path) -> io::Result<()> {
    Body::new(folder(path), Readers::All).map(drop)
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The new name outlives a power cut too, where a folder can be synced.
fn sync_folder(path: &Path) {
    let _ = File::open(folder(path)).and_then(|folder| folder.sync_all());
}
