//! The report as its reader meets it: in a browser, on paper, and without either.

#[path = "../../tests/browser/chromium.rs"]
mod chromium;

use assert_cmd::Command;
use chromium::Chromium;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const CAMPAIGNS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/campaigns");

fn tempco(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tempco"));
    command.current_dir(folder).env("NO_COLOR", "1");
    command
}

/// Every checked-in campaign.
fn campaigns() -> Vec<PathBuf> {
    let files = fs::read_dir(CAMPAIGNS).expect("campaigns").flatten().map(|entry| entry.path());
    let mut campaigns: Vec<PathBuf> = files.filter(|file| file.extension().is_some_and(|end| end == "csv")).collect();
    campaigns.sort();
    assert!(!campaigns.is_empty());
    campaigns
}

/// A report on a model of the campaign.
fn report(folder: &Path, campaign: &Path) -> PathBuf {
    let data = campaign.to_str().expect("a path in Unicode");
    tempco(folder).args(["train", data, "-o", "model.toml", "--restarts", "4"]).assert().success();
    tempco(folder).args(["compare", "model.toml", data, "--report", "report.html"]).assert().success();
    folder.join("report.html")
}

/// Where pictures are kept for people to look at.
fn pictures(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("report").join(name)
}

#[test]
fn every_chart_is_drawn_in_light_in_dark_and_on_paper_and_the_console_stays_silent() {
    let mut browser = Chromium::start();
    for campaign in campaigns() {
        let folder = TempDir::new().expect("a folder");
        let name = campaign.file_stem().expect("a name").to_string_lossy().into_owned();
        let file = report(folder.path(), &campaign);
        for scheme in ["light", "dark"] {
            browser.screen(1280, 900, scheme);
            browser.visit(&format!("file://{}", file.display()));
            let described = browser.evaluate("JSON.parse(document.getElementById('data').textContent).charts.length");
            let drawn = browser.evaluate(
                "[...document.querySelectorAll('svg.plot')].filter((plot) => \
                 [...plot.querySelectorAll('.mark')].some((mark) => mark.getBoundingClientRect().width > 1)).length",
            );
            assert_eq!(drawn, described, "{name}, {scheme}");
            assert!(described.as_u64() > Some(4), "{described} charts");
            browser.screenshot(&pictures(&format!("{name}-{scheme}.png")));
        }
        browser.print(&pictures(&format!("{name}.pdf")));
    }
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn a_mark_can_be_read_by_pointer_and_by_keys_and_magnified() {
    let folder = TempDir::new().expect("a folder");
    let file = report(folder.path(), &campaigns()[0]);
    let mut browser = Chromium::start();
    browser.screen(1280, 900, "light");
    browser.visit(&format!("file://{}", file.display()));
    browser.evaluate("globalThis.plot = () => document.querySelector('#residual-temperature svg.plot')");
    browser.evaluate("(plot().scrollIntoView(), plot().focus())");
    let readout = "document.querySelector('#residual-temperature .readout').textContent";
    browser.key("ArrowRight");
    let first = browser.evaluate(readout);
    assert!(first.as_str().is_some_and(|text| text.contains("°C") && text.contains("run ")), "{first}");
    browser.key("PageDown");
    assert_ne!(browser.evaluate(readout), first);

    let place = |browser: &mut Chromium, across: f64, down: f64| {
        let rectangle = browser.evaluate("plot().getBoundingClientRect().toJSON()");
        let number = |name: &str| rectangle[name].as_f64().expect("a number");
        (number("x") + number("width") * across, number("y") + number("height") * down)
    };
    let ticks = "[...plot().querySelectorAll('.grid text')].map((text) => text.textContent)";
    let before = browser.evaluate(ticks);
    for (kind, across, down) in [("mousePressed", 0.4, 0.3), ("mouseMoved", 0.6, 0.6), ("mouseReleased", 0.7, 0.7)] {
        let (x, y) = place(&mut browser, across, down);
        browser.mouse(kind, x, y);
    }
    assert_ne!(browser.evaluate(ticks), before, "dragging magnifies");
    browser.evaluate("plot().focus()");
    browser.key("Escape");
    assert_eq!(browser.evaluate(ticks), before, "Escape goes back");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn the_report_is_one_file_that_asks_nothing_of_the_network_and_the_same_every_time() {
    let folder = TempDir::new().expect("a folder");
    let first = fs::read_to_string(report(folder.path(), &campaigns()[0])).expect("written");
    let again = fs::read_to_string(report(folder.path(), &campaigns()[0])).expect("written");
    assert!(first == again, "the same input gives other bytes");
    let address = |text: &str| text.contains("://") && !text.contains("http://www.w3.org/2000/svg");
    let addresses: Vec<&str> = first.lines().filter(|line| address(line)).collect();
    assert_eq!(addresses, [""; 0]);
    for loaded in [" src=", "<link", "@import", "url(\"", "fetch("] {
        assert!(!first.contains(loaded), "{loaded}");
    }
    assert!(first.len() < 1_000_000, "{} bytes", first.len());
}
