//! A workbench that runs, and a client that says exactly the bytes that a test wants said.

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

pub const SMALL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns/small.csv");

/// How long a busy machine may take for the longest piece of work.
const PATIENCE: Duration = Duration::from_secs(600);
const LOOKS: u32 = 20_000;
const LOOK: Duration = Duration::from_millis(30);

/// A workbench in a folder of its own; dropping it stops it.
pub struct Served {
    process: Child,
    pub folder: TempDir,
    pub url: String,
    pub port: u16,
    token: String,
}

/// What came back.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&self.body)))
    }
}

impl Served {
    /// Starts it with these arguments.
    pub fn start<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Self {
        Self::start_in(TempDir::new().expect("a folder"), arguments)
    }

    /// In a folder where there is something already.
    pub fn start_in<S: AsRef<std::ffi::OsStr>>(folder: TempDir, arguments: &[S]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_tempco"))
            .arg("workbench")
            .args(arguments)
            .current_dir(folder.path())
            .env("NO_COLOR", "1")
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("piped")).read_line(&mut line).expect("text");
        let url = line.split_whitespace().nth(1).expect("an address").to_owned();
        let (address, token) = url.split_once("/#").expect("a token");
        let port = address.rsplit_once(':').and_then(|(_, port)| port.parse().ok()).expect("a port");
        Self { process, folder, token: token.to_owned(), port, url }
    }

    /// On the small campaign, once it is read.
    pub fn small() -> Self {
        let served = Self::start(&[SMALL]);
        served.settled();
        served
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("tempco-workbench").join(name)
    }

    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, b"")
    }

    pub fn post(&self, verb: &str, body: &str) -> Answer {
        self.ask("POST", &format!("/api/{verb}"), body.as_bytes())
    }

    /// Carries out a verb and waits until the work has ended.
    pub fn done(&self, verb: &str, body: &str) -> Value {
        let answer = self.post(verb, body);
        assert_eq!(answer.status, 204, "{verb} {body}: {}", String::from_utf8_lossy(&answer.body));
        self.settled()
    }

    /// Opens a folder for files that belong together.
    pub fn uploads(&self) -> u64 {
        self.post("uploads", "{}").json()["upload"].as_u64().expect("a number")
    }

    pub fn upload(&self, upload: u64, name: &str, content: &str) -> Answer {
        self.ask("POST", &format!("/api/upload?upload={upload}&name={name}"), content.as_bytes())
    }

    /// Drops one file and waits until it is read.
    pub fn dropped(&self, name: &str, content: &str) -> Value {
        let upload = self.uploads();
        assert_eq!(self.upload(upload, name, content).status, 204, "{name}");
        self.done("load", &serde_json::json!({ "upload": upload, "files": [name] }).to_string())
    }

    pub fn state(&self) -> Value {
        self.get("/api/state").json()
    }

    /// The state once nothing goes on.
    pub fn settled(&self) -> Value {
        for _ in 0..LOOKS {
            let state = self.state();
            if state["job"].is_null() {
                return state;
            }
            std::thread::sleep(LOOK);
        }
        panic!("still at work: {}", self.state()["job"]);
    }

    fn ask(&self, method: &str, path: &str, body: &[u8]) -> Answer {
        let own = format!("Host: 127.0.0.1:{}\r\nx-tempco-token: {}\r\n", self.port, self.token);
        self.say(method, path, &own, body)
    }

    /// The token as the page would send it.
    pub fn token_header(&self) -> String {
        format!("x-tempco-token: {}\r\n", self.token)
    }

    /// A request with exactly these header lines.
    pub fn say(&self, method: &str, path: &str, headers: &str, body: &[u8]) -> Answer {
        let mut stream = self.begin(method, path, headers, body);
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8(answer[..end].to_vec()).expect("text").to_lowercase();
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        Answer { status, head, body: answer[end + 4..].to_vec() }
    }

    /// Sends a request and leaves the answer to be read.
    pub fn begin(&self, method: &str, path: &str, headers: &str, body: &[u8]) -> TcpStream {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket's option");
        let length = body.len();
        let head =
            format!("{method} {path} HTTP/1.1\r\n{headers}Connection: close\r\nContent-Length: {length}\r\n\r\n");
        stream.write_all(head.as_bytes()).expect("it reads");
        stream.write_all(body).expect("it reads");
        stream
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The small campaign so many times over, each run under names of its own.
pub fn repeated(folder: &Path, times: usize) -> PathBuf {
    let small = std::fs::read_to_string(SMALL).expect("checked in");
    let (head, rows) = small.split_once('\n').expect("a header");
    assert!(head.starts_with("run,"), "{head}");
    let again = |time: usize| rows.lines().map(move |row| row.replacen(',', &format!("-{time},"), 1));
    let all: Vec<String> = (0..times).flat_map(again).collect();
    let file = folder.join(format!("{times}-times.csv"));
    std::fs::write(&file, format!("{head}\n{}\n", all.join("\n"))).expect("written");
    file
}
