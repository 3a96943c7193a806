//! Files and folders to one campaign.

use super::Campaign;
use super::columns::Layout;
use super::error::{CampaignError, Facts, Place};
use super::options::{ReadAs, ReadOptions};
use super::quantity::Quantity;
use super::rows::{Content, read_rows};
use super::run::Run;
use super::table::Table;
use super::text::unreadable;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

impl Campaign {
    /// Reads files, and folders of `.csv` files (in the order of their names), into one campaign.
    ///
    /// Without a `run` column a file is one run of the file's name; files of the same name in several
    /// folders are told apart by their folder. A `campaign.toml` beside a file says how to read it; `options`
    /// count more than it does.
    ///
    /// # Errors
    /// The first thing that cannot be trusted, with its place; see [`CampaignError`].
    pub fn read(paths: &[PathBuf], options: &ReadOptions) -> Result<Self, CampaignError> {
        Self::read_like(paths, options, &ReadAs::default())
    }

    /// Reads as files before were read, which a model file says, unless `options` or a `campaign.toml` say otherwise.
    ///
    /// # Errors
    /// As [`Campaign::read`].
    pub fn read_like(paths: &[PathBuf], options: &ReadOptions, before: &ReadAs) -> Result<Self, CampaignError> {
        let files = files(paths)?;
        let names = run_names(&files);
        let contents: Vec<_> =
            files.par_iter().zip(&names).map(|(file, name)| read_file(file, name, options, before)).collect();
        // Collecting before looking makes the first file's error the one that is told.
        merge(contents.into_iter().collect::<Result<_, _>>()?)
    }
}

/// One file's content and how it was understood.
struct File {
    path: PathBuf,
    quantity: Quantity,
    content: Content,
    read_as: ReadAs,
}

fn read_file(path: &Path, run_name: &str, options: &ReadOptions, before: &ReadAs) -> Result<File, CampaignError> {
    let table = Table::open(path)?;
    let read_as = before.for_table(options, &table)?;
    let options = read_as.merged();
    let layout = Layout::of(&table, &options)?;
    let content = read_rows(&table, layout, run_name)?;
    Ok(File { path: path.to_owned(), quantity: options.quantity(), content, read_as })
}

/// How all files were read. Where they differ in it, each needs a `campaign.toml` of its own again.
fn read_as(files: &[File]) -> ReadAs {
    let [first, others @ ..] = files else { return ReadAs::default() };
    let mut read_as = first.read_as.clone();
    if others.iter().any(|file| file.read_as.manifest != read_as.manifest) {
        read_as.manifest = ReadOptions::default();
    }
    if others.iter().any(|file| file.read_as.options != read_as.options) {
        read_as.options = ReadOptions::default();
    }
    read_as
}

/// The files that the paths stand for.
fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CampaignError> {
    if paths.is_empty() {
        let facts = Facts::boxed(Place::campaign(), "no path", "a .csv file or a folder of them");
        return Err(CampaignError::NothingGiven(facts));
    }
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            files.extend(tables_in(path)?);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

/// The folder's tables, sorted by name; what begins with a dot is no one's data.
fn tables_in(folder: &Path) -> Result<Vec<PathBuf>, CampaignError> {
    let mut tables = Vec::new();
    let mut others = Vec::new();
    for entry in folder.read_dir().map_err(|error| unreadable(folder, &error))? {
        let path = entry.map_err(|error| unreadable(folder, &error))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') {
            continue;
        }
        if name.to_lowercase().ends_with(".csv") { tables.push(path) } else { others.push(name) }
    }
    if tables.is_empty() {
        others.sort_unstable();
        others.truncate(5);
        let found = if others.is_empty() { "no files".to_owned() } else { format!("only {}", others.join(", ")) };
        return Err(CampaignError::NoTables(Facts::boxed(Place::file(folder), found, "files ending in .csv")));
    }
    tables.sort_unstable();
    Ok(tables)
}

/// Names for the runs of files that do not name theirs.
fn run_names(files: &[PathBuf]) -> Vec<String> {
    let stem = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut uses: HashMap<String, usize> = HashMap::new();
    for file in files {
        *uses.entry(stem(file)).or_default() += 1;
    }
    let name = |file: &PathBuf| {
        let folder = file.parent().and_then(Path::file_name);
        match folder {
            Some(folder) if uses.get(&stem(file)).is_some_and(|&uses| uses > 1) => {
                format!("{}/{}", folder.to_string_lossy(), stem(file))
            }
            _ => stem(file),
        }
    };
    files.iter().map(name).collect()
}

fn merge(files: Vec<File>) -> Result<Campaign, CampaignError> {
    let mut channels: Option<(PathBuf, Vec<String>)> = None;
    let mut quantity: Option<Quantity> = None;
    let mut runs: Vec<Run> = Vec::new();
    let mut sources: HashMap<String, PathBuf> = HashMap::new();
    let mut ignored = Vec::new();
    let read_as = read_as(&files);
    for File { path, quantity: of_file, mut content, .. } in files {
        check_quantity(&path, quantity.get_or_insert_with(|| of_file.clone()), &of_file)?;
        let (first, names) = channels.get_or_insert_with(|| (path.clone(), content.channels.clone()));
        arrange(&path, &mut content, first, names)?;
        for run in &content.runs {
            if let Some(first) = sources.insert(run.name.clone(), path.clone()) {
                return Err(run_twice(&path, &run.name, &first));
            }
        }
        runs.append(&mut content.runs);
        ignored.append(&mut content.ignored);
    }
    let mut seen = HashSet::new();
    ignored.retain(|name| seen.insert(name.clone()));
    let channels = channels.map(|(_, names)| names).unwrap_or_default();
    Ok(Campaign { ignored_columns: ignored, read_as, ..Campaign::new(runs, channels, quantity.unwrap_or_default()) })
}

/// Puts a file's channels into the campaign's order.
fn arrange(path: &Path, content: &mut Content, first: &Path, names: &[String]) -> Result<(), CampaignError> {
    if content.channels == names {
        return Ok(());
    }
    let lacking = |path: &Path, other: &Path, channel: &String| {
        let expected = format!("{channel}, as in {}", other.display());
        let facts = Facts::boxed(Place::file(path), "no such column of numbers", expected);
        CampaignError::ChannelsDiffer { facts, channel: channel.clone() }
    };
    if let Some(surplus) = content.channels.iter().find(|name| !names.contains(name)) {
        return Err(lacking(first, path, surplus));
    }
    let position = |name: &String| content.channels.iter().position(|channel| channel == name);
    let order = names.iter().map(|name| position(name).ok_or_else(|| lacking(path, first, name)));
    let order = order.collect::<Result<Vec<_>, _>>()?;
    for run in &mut content.runs {
        run.reorder_channels(&order);
    }
    Ok(())
}

fn check_quantity(path: &Path, first: &Quantity, found: &Quantity) -> Result<(), CampaignError> {
    if first == found {
        return Ok(());
    }
    let text = |quantity: &Quantity| format!("{} against {}", quantity.signal_unit, quantity.reference_unit);
    let expected = format!("{}, as in the files before", text(first));
    Err(CampaignError::QuantitiesDiffer(Facts::boxed(Place::file(path), text(found), expected)))
}

fn run_twice(path: &Path, name: &str, first: &Path) -> CampaignError {
    let found = format!("run {name}, which {} holds already", first.display());
    CampaignError::RunTwice(Facts::boxed(Place::file(path), found, "a name that no other file uses"))
}
