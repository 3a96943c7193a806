//! Where things are kept in the folder: whatever lies there already keeps its name, whoever put it there and when.

use crate::failure::Failure;
use std::fs::{File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The folder for this workbench alone, as long as what is returned lives: two would take each other's names.
pub fn claimed(folder: &Path) -> Result<Option<File>, Failure> {
    // Where a folder can't be locked, as on some network drives, there is no claim.
    let Ok(claim) = File::open(folder) else { return Ok(None) };
    match claim.try_lock() {
        Ok(()) => Ok(Some(claim)),
        Err(TryLockError::WouldBlock) => {
            Err(Failure::new(format_args!("{}: another workbench keeps its files here", folder.display()))
                .help("close it, or name another folder with --output"))
        }
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Whether anything has this name: a file, a folder, a link to nowhere.
pub fn is_taken(path: &Path) -> bool {
    !std::fs::symlink_metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound)
}

pub fn model(folder: &Path, number: usize) -> PathBuf {
    folder.join(format!("model-{number}.toml"))
}

pub fn calibration(folder: &Path, number: usize, ending: &str) -> PathBuf {
    folder.join(format!("calibration-{number}.{ending}"))
}

/// For the plan of a model; planned again it gets another one.
pub fn plan(folder: &Path, number: usize) -> PathBuf {
    let name = |time: usize| if time == 1 { format!("plan-{number}") } else { format!("plan-{number}-{time}") };
    first_free((1..).map(|time| folder.join(name(time))))
}

/// A number under which nothing is kept yet.
pub fn is_free(folder: &Path, number: usize) -> bool {
    let calibrations = ["hex", "bin"].map(|ending| calibration(folder, number, ending));
    let others = [model(folder, number), folder.join(format!("plan-{number}"))];
    !calibrations.iter().chain(&others).any(|path| is_taken(path))
}

/// Makes a new folder `STEM-1`, `STEM-2`, …
pub fn new_folder(folder: &Path, stem: &str) -> Result<PathBuf, Failure> {
    let path = first_free((1..).map(|number: usize| folder.join(format!("{stem}-{number}"))));
    // Refuses what has been put there since.
    std::fs::create_dir(&path).map_err(|error| Failure::io(&path, &error))?;
    Ok(path)
}

fn first_free(mut paths: impl Iterator<Item = PathBuf>) -> PathBuf {
    paths.find(|path| !is_taken(path)).unwrap_or_default()
}

/// Refuses what is not a plain file: reading it might never end, or lead out of the folder.
pub fn plain_file(path: &Path) -> Result<(), Failure> {
    let kind = std::fs::symlink_metadata(path).map_err(|error| Failure::io(path, &error))?.file_type();
    if kind.is_file() {
        return Ok(());
    }
    let what = if kind.is_symlink() {
        "a link to elsewhere"
    } else if kind.is_dir() {
        "a folder"
    } else {
        "a pipe or a device"
    };
    Err(Failure::new(format_args!("{}: this is {what}, not a file", path.display())).help("drop the file itself"))
}
