use super::*;
use std::fs;
use std::io::Read;
use tempfile::TempDir;

const OURS: &[u8] = b"a model";

/// What stands in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().into_string().expect("plain letters")).collect();
    names.sort();
    names
}

fn model(path: &Path, force: bool) -> Output {
    Output::file(path, Kind::Model, "-o", Force { force })
}

#[test]
fn what_is_prepared_is_seen_when_it_is_placed_and_not_before() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("model.toml");
    let output = model(&path, true);
    drop(output.prepare(OURS).expect("written"));
    assert!(!path.exists());
    let prepared = output.prepare(OURS).expect("written");
    assert!(!path.exists());
    prepared.place().expect("placed");
    assert_eq!(fs::read(&path).expect("readable"), OURS);

    let mut reader = fs::File::open(&path).expect("readable");
    let prepared = output.prepare(b"another").expect("written");
    assert_eq!(fs::read(&path).expect("readable"), OURS);
    prepared.place().expect("placed");
    assert_eq!(fs::read(&path).expect("readable"), b"another");
    // The name went to another file: who had opened the old one reads it to its end.
    let mut old = Vec::new();
    reader.read_to_end(&mut old).expect("readable");
    assert_eq!(old, OURS);
    assert_eq!(names(folder.path()), ["model.toml"]);
}

#[test]
fn what_came_to_the_place_meanwhile_stays_there() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("model.toml");
    let output = model(&path, false);
    output.check().expect("a free name");
    let prepared = output.prepare(OURS).expect("written");
    fs::write(&path, "three days of measurements").expect("written");
    let refused = prepared.place().expect_err("it is somebody's").to_string();
    assert!(refused.contains("not written by tempco"), "{refused}");
    assert_eq!(fs::read(&path).expect("readable"), b"three days of measurements");
    assert_eq!(names(folder.path()), ["model.toml"]);

    let forced = model(&path, true);
    forced.write(OURS).expect("forced");
    assert_eq!(fs::read(&path).expect("readable"), OURS);
    // Not even by force over what the command reads.
    fs::write(&path, "an input").expect("written");
    let refused = forced.reading([&path]).write(OURS).expect_err("an input").to_string();
    assert!(refused.contains("this command reads it"), "{refused}");
    assert_eq!(fs::read(&path).expect("readable"), b"an input");
}

#[test]
fn a_key_gets_a_name_that_nobody_has_or_none() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("factory.key");
    write_secret(&path, b"first").expect("a free name");
    for write in [write_secret, write_new] {
        write(&path, b"second").expect_err("taken");
        assert_eq!(fs::read(&path).expect("readable"), b"first");
    }
    assert_eq!(fs::metadata(&path).expect("there").permissions().mode() & 0o777, 0o600);
    // A link that leads nowhere would lead there then.
    let link = folder.path().join("link.key");
    symlink("elsewhere", &link).expect("a link");
    write_secret(&link, b"third").expect_err("taken");
    assert_eq!(names(folder.path()), ["factory.key", "link.key"]);
}

#[test]
fn what_killed_processes_left_goes_and_nothing_else() {
    let folder = TempDir::new().expect("a folder");
    let file = |name: &str| fs::File::create(folder.path().join(name)).expect("a file");
    let being_written = file(".tempco-12345678.part");
    being_written.try_lock().expect("a lock");
    let others = [".tempco-abc.part", ".tempco-abcdefg-.part", ".tempco-abcdefgh.toml", "tempco-abcdefgh.part"];
    for name in others.iter().chain(&[".tempco-abcdEFG8.part"]) {
        drop(file(name));
    }
    fs::create_dir(folder.path().join(".tempco-aaaaaaaa.part")).expect("a folder");
    model(&folder.path().join("model.toml"), false).check().expect("a free name");
    let mut expected = [&others[..], &[".tempco-12345678.part", ".tempco-aaaaaaaa.part"]].concat();
    expected.sort_unstable();
    assert_eq!(names(folder.path()), expected);
}

#[test]
fn what_cannot_be_written_is_said_when_it_is_looked_at() {
    let folder = TempDir::new().expect("a folder");
    let refused = |path: &Path| model(path, true).check().expect_err("no place").to_string();
    let text = refused(&folder.path().join("nowhere/model.toml"));
    assert!(text.contains("its folder is not there"), "{text}");
    assert!(refused(folder.path()).contains("this is a folder"));
    let taken = folder.path().join("notes.txt");
    fs::write(&taken, "mine").expect("written");
    fs::write(folder.path().join("notes.toml"), "mine too").expect("written");
    let text = model(&taken, false).check().expect_err("somebody's").to_string();
    let free = folder.path().join("notes-2.toml");
    assert!(text.contains(&format!("choose another name: -o {}, or add --force if ", free.display())), "{text}");
    let text = Output::in_folder(&taken, Kind::Model, "--output", Force::default()).check();
    assert!(text.expect_err("somebody's").to_string().contains("choose another folder: --output FOLDER, or add"));
    let text = Output::own(&taken, Kind::Model).check().expect_err("somebody's").to_string();
    assert!(text.contains("move it to another folder") && !text.contains("--force"), "{text}");
    model(Path::new("/dev/null"), false).check().expect("a device takes what it is given");
    model(Path::new("/dev/null"), false).write(OURS).expect("a device takes what it is given");
}

#[test]
fn whoever_cannot_write_is_told_what_would_help() {
    for (kind, help) in [
        (io::ErrorKind::NotFound, "make it first, or choose another one"),
        (io::ErrorKind::PermissionDenied, "choose a folder that you may write to"),
        (io::ErrorKind::ReadOnlyFilesystem, "choose a folder that you may write to"),
        (io::ErrorKind::StorageFull, "what was there before is as it was"),
        (io::ErrorKind::QuotaExceeded, "what was there before is as it was"),
        (io::ErrorKind::FileTooLarge, "what was there before is as it was"),
    ] {
        let text = failed(Path::new("a.toml"), &kind.into()).to_string();
        assert!(text.contains("a.toml: ") && text.contains(help), "{text}");
    }
    assert!(!failed(Path::new("a.toml"), &io::ErrorKind::Other.into()).to_string().contains("help"));
}

#[test]
fn a_link_stays_and_the_file_that_it_names_is_replaced() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = TempDir::new().expect("a folder");
    let (there, link) = (folder.path().join("there"), folder.path().join("link.toml"));
    fs::create_dir(&there).expect("a folder");
    let (named, second) = (there.join("model.toml"), there.join("second.toml"));
    fs::write(&named, "old").expect("written");
    fs::set_permissions(&named, fs::Permissions::from_mode(0o640)).expect("its own");
    fs::hard_link(&named, &second).expect("a second name");
    symlink("there/model.toml", &link).expect("a link");
    model(&link, true).write(OURS).expect("written");
    assert_eq!(fs::read_link(&link).expect("still a link"), Path::new("there/model.toml"));
    assert_eq!(fs::read(&named).expect("readable"), OURS);
    assert_eq!(fs::metadata(&named).expect("there").permissions().mode() & 0o777, 0o640);
    // The old bytes' second name keeps them.
    assert_eq!(fs::read(&second).expect("readable"), b"old");
    assert_eq!(names(&there), ["model.toml", "second.toml"]);
    assert_eq!(names(folder.path()), ["link.toml", "there"]);

    fs::remove_file(&named).expect("removed");
    let refused = model(&link, true).check().expect_err("nothing there").to_string();
    assert!(refused.contains("leads nowhere"), "{refused}");
}
