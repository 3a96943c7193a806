//! Claim: a model file of another format is refused, by its number, before anything in it is believed.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;
use tests::workspace::root;
use trainer::campaign::{Campaign, HoldOut, ReadOptions};
use trainer::model::{Model, ModelError};
use trainer::progress::Quiet;
use trainer::train::{TrainSettings, train};

/// A model as this version writes it.
static TEXT: LazyLock<String> = LazyLock::new(|| {
    let file = root().join("tests/campaigns/small.csv");
    let campaign = Campaign::read(&[file], &ReadOptions::default()).expect("a campaign");
    let split = campaign.split(&HoldOut::LastOfEachKind).expect("a split");
    let settings = TrainSettings { restarts: 1, ..TrainSettings::new(1) };
    train(&campaign, &split, &settings, &Quiet).expect("a model").model.to_text()
});

fn written(folder: &Path, format: &str) -> PathBuf {
    let line = format!("format = {}\n", Model::FORMAT);
    assert_eq!(TEXT.matches(&line).count(), 1, "the file begins with its format");
    let path = folder.join("model.toml");
    std::fs::write(&path, TEXT.replace(&line, format)).expect("a writable folder");
    path
}

#[test]
fn every_other_format_is_refused_by_its_number() {
    let folder = TempDir::new().expect("a folder");
    for other in [0, Model::FORMAT - 1, Model::FORMAT + 1, 99, u32::MAX] {
        let path = written(folder.path(), &format!("format = {other}\n"));
        match Model::read(&path) {
            Err(ModelError::Format { found, supported, .. }) => {
                assert_eq!((found, supported), (i64::from(other), Model::FORMAT));
            }
            read => panic!("format {other}: {read:?}"),
        }
    }
}

#[test]
fn a_file_that_does_not_say_its_format_is_no_model() {
    let folder = TempDir::new().expect("a folder");
    for line in ["", "format = \"1\"\n", "format = 1.0\n"] {
        let path = written(folder.path(), line);
        assert!(matches!(Model::read(&path), Err(ModelError::Syntax { .. })), "{line:?}");
    }
    for line in ["format = -1\n", "format = 4294967297\n"] {
        let path = written(folder.path(), line);
        assert!(matches!(Model::read(&path), Err(ModelError::Format { .. })), "{line:?}");
    }
}

#[test]
fn the_format_of_this_version_is_read_back_as_it_was_written() {
    let folder = TempDir::new().expect("a folder");
    let path = written(folder.path(), &format!("format = {}\n", Model::FORMAT));
    assert_eq!(Model::read(&path).expect("its own format").to_text(), *TEXT);
}
