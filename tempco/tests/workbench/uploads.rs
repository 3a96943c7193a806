//! Files that are dropped: whole or not there, each drop for itself, and no name leads anywhere else.

use super::served::{SMALL, Served};
use serde_json::json;
use std::fs;
use std::io::Write;
use std::net::TcpStream;
use std::time::Duration;

fn other_names() -> String {
    fs::read_to_string(SMALL).expect("checked in").replacen("temperature_c", "Warmth", 1)
}

#[test]
fn a_mapping_file_says_nothing_about_later_files() {
    let served = Served::small();
    let upload = served.uploads();
    let mapping = "[columns]\ntemperature_c = \"Warmth\"\n";
    assert_eq!(served.upload(upload, "campaign.toml", mapping).status, 204);
    assert_eq!(served.upload(upload, "first.csv", &other_names()).status, 204);
    let state = served.done("load", r#"{"upload":1,"files":["campaign.toml","first.csv"]}"#);
    assert_eq!((&state["refused"], &state["campaign"]["rows"]), (&json!(null), &json!(2736)));
    assert_eq!(state["campaign"]["mappings"], json!(["tempco-workbench/upload-1/campaign.toml"]));
    let state = served.dropped("second.csv", &other_names());
    assert!(state["refused"]["message"].as_str().expect("refused").contains("temperature_c"), "{}", state["refused"]);
    let state = served.dropped("third.csv", &fs::read_to_string(SMALL).expect("checked in"));
    assert_eq!((&state["refused"], &state["campaign"]["mappings"]), (&json!(null), &json!([])));
    // What was read is closed: its mapping can't change afterwards.
    assert_eq!(served.upload(upload, "campaign.toml", mapping).status, 422);
    let upload = served.uploads();
    assert_eq!(served.upload(upload, "mapping.toml", mapping).status, 204);
    let load = json!({ "upload": upload, "files": ["mapping.toml"] }).to_string();
    assert_eq!(served.post("load", &load).status, 422, "what isn't used is said");
}

#[test]
fn an_upload_that_breaks_off_leaves_the_earlier_file_and_nothing_else() {
    let served = Served::small();
    let upload = served.uploads();
    assert_eq!(served.upload(upload, "a.csv", "the whole file").status, 204);
    for name in ["a.csv", "b.csv"] {
        let path = format!("/api/upload?upload={upload}&name={name}");
        let head = format!(
            "POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}Content-Length: 1000\r\n\r\nhalf",
            served.port,
            served.token_header()
        );
        let mut stream = TcpStream::connect(("127.0.0.1", served.port)).expect("it listens");
        stream.write_all(head.as_bytes()).expect("it reads");
        std::thread::sleep(Duration::from_millis(300));
    }
    let listed = || -> Vec<String> {
        let entries = fs::read_dir(served.path("upload-1")).expect("a folder");
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    };
    for _ in 0..100 {
        if listed() == ["a.csv"] {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(listed(), ["a.csv"]);
    assert_eq!(fs::read(served.path("upload-1/a.csv")).expect("there"), b"the whole file");
    // Two files of one name in one drop: the second must not take the first one's place.
    let again = served.upload(upload, "a.csv", "another");
    assert!(again.status == 422 && String::from_utf8_lossy(&again.body).contains("rename one"));
    assert_eq!(fs::read(served.path("upload-1/a.csv")).expect("there"), b"the whole file");
}

#[test]
fn no_name_leads_out_of_the_folder_and_no_size_fills_the_disk() {
    let served = Served::small();
    let upload = served.uploads();
    let long = "x".repeat(4000);
    for name in
        ["", ".", "..", "..%2Fa.csv", "a%2Fb.csv", "%2Fetc%2Fpasswd", ".hidden", "a%0Ab.csv", "%1B.csv", "%00", &long]
    {
        let answer = served.upload(upload, name, "x");
        let said = String::from_utf8_lossy(&answer.body).into_owned();
        assert!(answer.status == 422 && said.contains("help") && said.len() < 500, "{name}: {} {said}", answer.status);
    }
    assert_eq!(served.upload(99, "a.csv", "x").status, 422);
    let head = format!("Host: 127.0.0.1:{}\r\n{}", served.port, served.token_header());
    let mut stream = TcpStream::connect(("127.0.0.1", served.port)).expect("it listens");
    let huge =
        format!("POST /api/upload?upload=1&name=huge.csv HTTP/1.1\r\n{head}Content-Length: 9999999999999\r\n\r\n");
    stream.write_all(huge.as_bytes()).expect("it reads");
    stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a socket's option");
    let mut answer = [0; 12];
    std::io::Read::read_exact(&mut stream, &mut answer).expect("an answer before the body");
    assert_eq!(&answer, b"HTTP/1.1 422");
    assert_eq!(fs::read_dir(served.path("upload-1")).expect("a folder").count(), 0);
}

#[cfg(unix)]
#[test]
fn a_pipe_or_a_link_among_the_uploads_is_refused_at_once() {
    let served = Served::small();
    let upload = served.uploads();
    let place = |name: &str| served.path("upload-1").join(name);
    let made = std::process::Command::new("mkfifo").arg(place("pipe.csv")).status().expect("mkfifo");
    assert!(made.success());
    let secret = served.folder.path().join("secret");
    fs::write(&secret, "kept").expect("written");
    std::os::unix::fs::symlink(&secret, place("link.csv")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", place("device.csv")).expect("a link");
    fs::create_dir(place("folder.csv")).expect("a folder");
    for name in ["pipe.csv", "link.csv", "device.csv", "folder.csv"] {
        assert_eq!(served.upload(upload, name, "x").status, 422, "{name}");
        let load = json!({ "upload": upload, "files": [name] }).to_string();
        let answer = served.post("load", &load);
        assert!(answer.status == 422 && String::from_utf8_lossy(&answer.body).contains("not a file"), "{name}");
    }
    assert_eq!(fs::read(&secret).expect("there"), b"kept");
    // A mapping that nobody dropped is looked at, too.
    let small = fs::read_to_string(SMALL).expect("checked in");
    assert_eq!(served.upload(upload, "good.csv", &small).status, 204);
    std::os::unix::fs::symlink("/dev/zero", place("campaign.toml")).expect("a link");
    let load = json!({ "upload": upload, "files": ["good.csv"] }).to_string();
    assert_eq!(served.post("load", &load).status, 422);
    fs::remove_file(place("campaign.toml")).expect("there");
    assert_eq!(served.done("load", &load)["refused"], json!(null));
}
