//! A real browser for tests: Chromium without a window, spoken to over its DevTools protocol.
//!
//! Test crates take this file in with `#[path]`. It knows one page, and remembers everything that the
//! page's console complained of.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

const FLAGS: [&str; 12] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "about:blank",
];
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// Keys that a browser knows by number.
const KEYS: [(&str, u8); 7] = [
    ("Tab", 9),
    ("Enter", 13),
    ("Escape", 27),
    ("ArrowLeft", 37),
    ("ArrowUp", 38),
    ("ArrowRight", 39),
    ("ArrowDown", 40),
];
/// How long a busy machine may take for an answer.
const PATIENCE: Duration = Duration::from_secs(60);
const LOOK: Duration = Duration::from_millis(50);
/// Looks at a page until it must have become what is waited for.
const LOOKS: usize = 1200;

/// A browser with one page; dropping it closes it.
pub struct Chromium {
    process: Child,
    line: WebSocket<TcpStream>,
    session: String,
    last_id: u64,
    complaints: Vec<String>,
    // The profile, new and empty.
    _folder: TempDir,
    // Closed, it would end the browser at its next word.
    _stderr: BufReader<ChildStderr>,
}

impl Chromium {
    /// Starts the browser.
    ///
    /// # Panics
    /// With an instruction, if there is none.
    pub fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let mut process = spawn(folder.path());
        let mut stderr = BufReader::new(process.stderr.take().expect("piped"));
        let address = listening(&mut stderr);
        let (host, _) = address.split_once("/devtools").expect("an address of DevTools");
        let stream = TcpStream::connect(host).expect("the port that the browser named");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket's option");
        let (line, _) = tungstenite::client(format!("ws://{address}"), stream).expect("a WebSocket");
        let (session, complaints) = (String::new(), Vec::new());
        let mut browser = Self { process, line, session, last_id: 0, complaints, _folder: folder, _stderr: stderr };
        browser.attach();
        browser
    }

    fn attach(&mut self) {
        let target = self.call("Target.createTarget", &json!({ "url": "about:blank" }));
        let attached = self.call("Target.attachToTarget", &json!({ "targetId": target["targetId"], "flatten": true }));
        self.session = text(&attached["sessionId"]);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            self.call(&format!("{domain}.enable"), &json!({}));
        }
    }

    /// Opens an address and waits until it is loaded.
    pub fn visit(&mut self, url: &str) {
        let answer = self.call("Page.navigate", &json!({ "url": url }));
        assert!(answer["errorText"].is_null(), "{url}: {}", answer["errorText"]);
        self.wait_for("document.readyState === 'complete' && location.href !== 'about:blank'");
    }

    /// The value of an expression in the page; promises are waited for.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let parameters = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", &parameters);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn wait_for(&mut self, expression: &str) {
        for _ in 0..LOOKS {
            if self.evaluate(expression) == json!(true) {
                return;
            }
            std::thread::sleep(LOOK);
        }
        panic!("never true: {expression}");
    }

    /// Shows the page as on a screen of this size, in `light` or `dark`.
    pub fn screen(&mut self, width: u32, height: u32, scheme: &str) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", &size);
        let scheme = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.call("Emulation.setEmulatedMedia", &scheme);
    }

    /// One mouse event: `mousePressed`, `mouseMoved` or `mouseReleased`, in pixels of the screen.
    pub fn mouse(&mut self, kind: &str, x: f64, y: f64) {
        let down = u8::from(kind != "mouseReleased");
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": down, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", &event);
    }

    /// A key, pressed and released, with all that a browser does of itself: Tab moves on, Enter presses.
    pub fn key(&mut self, key: &str) {
        let code = KEYS.iter().find(|(name, _)| *name == key).map_or(0, |(_, code)| *code);
        let mut event = json!({ "type": "keyDown", "key": key, "code": key, "windowsVirtualKeyCode": code });
        if key == "Enter" {
            event["text"] = json!("\r");
        }
        self.call("Input.dispatchKeyEvent", &event);
        event["type"] = json!("keyUp");
        self.call("Input.dispatchKeyEvent", &event);
    }

    /// The whole page as PNG.
    pub fn screenshot(&mut self, file: &Path) {
        let answer = self.call("Page.captureScreenshot", &json!({ "format": "png", "captureBeyondViewport": true }));
        write(file, &answer["data"]);
    }

    /// The page as printed, as PDF.
    pub fn print(&mut self, file: &Path) {
        let answer = self.call("Page.printToPDF", &json!({ "printBackground": false, "preferCSSPageSize": true }));
        write(file, &answer["data"]);
    }

    /// Errors and warnings of the console, uncaught exceptions, and addresses that the page asked for and did not get.
    pub fn complaints(&self) -> &[String] {
        &self.complaints
    }

    fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.last_id += 1;
        let id = self.last_id;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.line.send(Message::text(message.to_string())).expect("the browser listens");
        loop {
            let message = self.line.read().unwrap_or_else(|error| panic!("{method}: no answer: {error}"));
            let Message::Text(message) = message else { continue };
            let message: Value = serde_json::from_str(&message).expect("DevTools speaks JSON");
            if message["id"] == json!(id) {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].clone();
            }
            self.complaints.extend(complaint(&message));
        }
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn spawn(profile: &Path) -> Child {
    let chosen = std::env::var("TEMPCO_BROWSER").ok();
    let names = chosen.as_deref().map_or(NAMES.to_vec(), |name| vec![name]);
    let start = |name: &&str| {
        let mut command = Command::new(name);
        command.args(FLAGS).arg(format!("--user-data-dir={}", profile.display()));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().ok()
    };
    names.iter().find_map(start).unwrap_or_else(|| {
        panic!(
            "no browser among {names:?}; install one, on Debian: apt-get install chromium, or name it in TEMPCO_BROWSER"
        )
    })
}

/// Where the browser listens, without `ws://`.
fn listening(stderr: &mut impl BufRead) -> String {
    let mut said = String::new();
    loop {
        let start = said.len();
        let read = stderr.read_line(&mut said).expect("text");
        assert!(read > 0, "the browser ended at once: {said}");
        if let Some((_, address)) = said[start..].split_once("DevTools listening on ws://") {
            return address.trim().to_owned();
        }
    }
}

fn complaint(event: &Value) -> Option<String> {
    let parameters = &event["params"];
    match event["method"].as_str()? {
        "Runtime.exceptionThrown" => Some(parameters["exceptionDetails"].to_string()),
        "Runtime.consoleAPICalled" if ["error", "warning", "assert"].contains(&parameters["type"].as_str()?) => {
            Some(parameters["args"].to_string())
        }
        "Log.entryAdded" if ["error", "warning"].contains(&parameters["entry"]["level"].as_str()?) => {
            Some(parameters["entry"].to_string())
        }
        "Network.loadingFailed" => Some(parameters.to_string()),
        _ => None,
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

fn write(file: &Path, base64: &Value) {
    let bytes = data_encoding::BASE64.decode(text(base64).as_bytes()).expect("base64");
    std::fs::create_dir_all(file.parent().expect("a folder")).expect("a writable folder");
    std::fs::write(file, bytes).expect("a writable folder");
}
