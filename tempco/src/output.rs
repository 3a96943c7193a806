//! The one way in which files are written. A measurement that is overwritten can't be made again, so a command looks before
//! it works: not over a file that it reads, nor over one that tempco did not write, nor over one of another kind. What it
//! writes appears whole or not at all.

mod kind;
mod whole;

pub use kind::{GENERATOR, Kind, with_mark};

use crate::failure::Failure;
use crate::shell;
use clap::Args;
use std::io;
use std::path::{Path, PathBuf};
use whole::{Draft, Readers};

/// Whether whatever stands there may go.
#[derive(Args, Clone, Copy, Default)]
pub struct Force {
    /// Writes over a file that tempco did not write, or of another kind; never over one that the command reads
    #[arg(long)]
    force: bool,
}

/// Where a command writes a file, and what must not be lost there.
#[derive(Clone)]
pub struct Output {
    path: PathBuf,
    kind: Kind,
    way_out: WayOut,
    inputs: Vec<PathBuf>,
}

/// What the user can do where the file may not be written.
#[derive(Clone, Copy)]
enum WayOut {
    /// Name another file with this option, or force it.
    File(&'static str, Force),
    /// Name another folder with this option, or force it.
    Folder(&'static str, Force),
    /// Move the file away.
    Move,
}

impl Output {
    /// A file that tempco names, in a folder of its own: nothing but the file itself can make way.
    pub fn own(path: &Path, kind: Kind) -> Self {
        Self { path: path.to_owned(), kind, way_out: WayOut::Move, inputs: Vec::new() }
    }

    /// A file that the user names with this option.
    pub fn file(path: &Path, kind: Kind, option: &'static str, force: Force) -> Self {
        Self { way_out: WayOut::File(option, force), ..Self::own(path, kind) }
    }

    /// A file in a folder that the user names with this option.
    pub fn in_folder(path: &Path, kind: Kind, option: &'static str, force: Force) -> Self {
        Self { way_out: WayOut::Folder(option, force), ..Self::own(path, kind) }
    }

    /// Not over any of these files; a folder stands for the tables in it.
    pub fn reading<'a>(self, inputs: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        Self { inputs: inputs.into_iter().flat_map(|input| files(input)).collect(), ..self }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Refuses what would lose something, or can't be done. Before the work, since after it would be too late.
    pub fn check(&self) -> Result<(), Failure> {
        let path = &self.path;
        whole::sweep(path);
        let refused = |why: &str| Failure::new(format_args!("{}: {why}", path.display()));
        let found = match std::fs::metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                if path.is_symlink() {
                    return Err(refused("this link leads nowhere").help(self.help()));
                }
                return whole::probe(path).map_err(|error| self.failed(&error));
            }
            found => found.map_err(|error| self.failed(&error))?,
        };
        if self.inputs.iter().any(|input| same_file::is_same_file(input, path).unwrap_or(false)) {
            let why = format!("this command reads it, and {} would take its place", self.kind.title());
            return Err(refused(&why).help(self.help_without_force()));
        }
        if found.is_dir() {
            return Err(refused("this is a folder").help(self.help_without_force()));
        }
        if !found.is_file() {
            return if is_disk(&found) { Err(refused("this is a whole disk")) } else { Ok(()) };
        }
        self.may_take_the_place_of_a_file(found.len())
    }

    fn may_take_the_place_of_a_file(&self, bytes: u64) -> Result<(), Failure> {
        let path = &self.path;
        // Nothing is lost with an empty file.
        let kind = if bytes == 0 { Some(self.kind) } else { Kind::of(path).map_err(|error| self.failed(&error))? };
        if kind != Some(self.kind) && !self.is_forced() {
            let what = kind.map_or("not written by tempco, or changed since,", |kind| kind.title());
            let why = format!("it is {what} and {} would take its place", self.kind.title());
            return Err(Failure::new(format_args!("{}: {why}", path.display())).help(self.help()));
        }
        whole::probe(&path.canonicalize().unwrap_or_else(|_| path.clone())).map_err(|error| self.failed(&error))
    }

    /// Writes the file whole, unless something else has come there meanwhile.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        self.prepare(bytes)?.place()
    }

    /// Writes the file where nobody sees it yet, so that several can appear together.
    pub fn prepare(&self, bytes: &[u8]) -> Result<Prepared<'_>, Failure> {
        let draft = Draft::of(&self.path, bytes, Readers::All).map_err(|error| self.failed(&error))?;
        Ok(Prepared { draft, output: self })
    }

    fn is_forced(&self) -> bool {
        matches!(self.way_out, WayOut::File(_, Force { force: true }) | WayOut::Folder(_, Force { force: true }))
    }

    fn help(&self) -> String {
        let name = shell::path(&self.path);
        match self.way_out {
            WayOut::File(..) | WayOut::Folder(..) => {
                format!("{}, or add --force if {name} may go", self.help_without_force())
            }
            WayOut::Move => self.help_without_force(),
        }
    }

    fn help_without_force(&self) -> String {
        match self.way_out {
            WayOut::File(option, _) => {
                format!("choose another name: {option} {}", shell::path(&self.free_name()))
            }
            WayOut::Folder(option, _) => format!("choose another folder: {option} FOLDER"),
            WayOut::Move => "move it to another folder".to_owned(),
        }
    }

    /// A name like the one that was chosen, of a file that is not there.
    fn free_name(&self) -> PathBuf {
        let usual = self.path.with_extension(self.kind.ending());
        let stem = usual.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let numbered = |number: usize| usual.with_file_name(format!("{stem}-{number}.{}", self.kind.ending()));
        let is_free = |path: &PathBuf| !path.exists() && !path.is_symlink();
        std::iter::once(usual.clone()).chain((2..).map(numbered)).find(is_free).unwrap_or(usual)
    }

    fn failed(&self, error: &io::Error) -> Failure {
        failed(&self.path, error)
    }
}

/// A file that is written and not yet at its place.
pub struct Prepared<'a> {
    draft: Draft,
    output: &'a Output,
}

impl Prepared<'_> {
    pub fn place(self) -> Result<(), Failure> {
        self.output.check()?;
        self.draft.place().map_err(|error| self.output.failed(&error))
    }
}

/// Writes a file beside its place, synced, and puts it there: whoever looks finds the old bytes or the new ones. Looks at
/// nothing: that is for [`Output`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    whole::sweep(path);
    Draft::of(path, bytes, Readers::All).and_then(Draft::place).map_err(|error| failed(path, &error))
}

/// The same for a name that nobody has.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    create(path, bytes, Readers::All)
}

/// The same for the owner's eyes only.
pub fn write_secret(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    create(path, bytes, Readers::Owner)
}

fn create(path: &Path, bytes: &[u8], readers: Readers) -> Result<(), Failure> {
    whole::sweep(path);
    Draft::of(path, bytes, readers).and_then(Draft::place_new).map_err(|error| failed(path, &error))
}

/// Makes a folder, and those that it lies in.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(folder, &error))
}

/// A file that does not get written leaves what was there.
fn failed(path: &Path, error: &io::Error) -> Failure {
    let failure = Failure::io(path, error);
    match error.kind() {
        io::ErrorKind::NotFound => failure.help("its folder is not there: make it first, or choose another one"),
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            failure.help("choose a folder that you may write to")
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            failure.help("make room, or choose another place; what was there before is as it was")
        }
        _ => failure,
    }
}

/// What a command reads where it is given this path.
fn files(input: &Path) -> Vec<PathBuf> {
    if input.is_dir() {
        return input.read_dir().into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    }
    vec![input.to_owned(), input.with_file_name("campaign.toml")]
}

#[cfg(unix)]
fn is_disk(found: &std::fs::Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_block_device(&found.file_type())
}

#[cfg(not(unix))]
fn is_disk(_: &std::fs::Metadata) -> bool {
    false
}

#[cfg(test)]
#[cfg(unix)]
mod tests;
