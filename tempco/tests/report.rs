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
fn a_reader_without_eyes_or_colours_gets_headings_tables_and_words() {
    let folder = TempDir::new().expect("a folder");
    let file = report(folder.path(), &campaigns()[0]);
    let mut browser = Chromium::start();
    browser.visit(&format!("file://{}", file.display()));
    let levels = browser.evaluate("[...document.querySelectorAll('h1,h2,h3')].map((heading) => +heading.tagName[1])");
    let levels: Vec<i64> = levels.as_array().expect("a list").iter().filter_map(serde_json::Value::as_i64).collect();
    assert_eq!(levels.iter().filter(|level| **level == 1).count(), 1);
    assert!(levels.windows(2).all(|pair| pair[1] <= pair[0] + 1), "a level is skipped: {levels:?}");
    for (what, nobody) in [
        ("a table without caption", "table:not(:has(> caption))"),
        ("a heading cell without scope", "th:not([scope])"),
        ("a plot that no key reaches", "svg.plot:not([tabindex='0'])"),
        ("a plot without words", "svg.plot:not([aria-label*='. '])"),
        ("a link to nowhere", "nav a:not([href^='#'])"),
    ] {
        assert_eq!(browser.evaluate(&format!("document.querySelectorAll(\"{nobody}\").length")), 0, "{what}");
    }
    let lost =
        "[...document.querySelectorAll('nav a')].filter((a) => !document.querySelector(a.getAttribute('href'))).length";
    assert_eq!(browser.evaluate(lost), 0, "a link without a target");
    // Shapes: no two series of a chart share one, whatever their colours.
    let shapes =
        "['first', 'second', 'third', 'fourth', 'fifth', 'sixth'].map((tone) => globalThis.charts.shape(tone, 0, 0))";
    assert_eq!(browser.evaluate(&format!("new Set({shapes}).size")), 6);
}

#[test]
fn twenty_thousand_marks_are_drawn_and_read_while_one_looks() {
    let folder = TempDir::new().expect("a folder");
    let file = report(folder.path(), &campaigns()[0]);
    let mut browser = Chromium::start();
    browser.visit(&format!("file://{}", file.display()));
    let spent = "(() => {
        const target = document.querySelector('.chart');
        const at = [...Array(20000).keys()];
        const axis = { label: 'x', unit: '', scale: 'linear', range: [0, 20000] };
        const dots = { mark: 'dots', name: 'many', tone: 'second', x: at, y: at.map((k) => k * 7919 % 20000), run: [] };
        const chart = { id: 'many', title: 'Many', caption: '', x: axis, y: axis, layers: [dots] };
        const times = [...Array(5)].map(() => {
            const start = performance.now();
            const { svg } = charts.draw(target, chart);
            svg.dispatchEvent(new PointerEvent('pointermove', { clientX: 300, clientY: 200 }));
            svg.getBoundingClientRect();
            return performance.now() - start;
        });
        return Math.min(...times);
    })()";
    let spent_ms = browser.evaluate(spent).as_f64().expect("a number");
    assert!(spent_ms < 100.0, "{spent_ms} ms");
}

#[test]
fn effects_are_a_ladder_and_a_diagnosis_is_there_when_asked_for() {
    let folder = TempDir::new().expect("a folder");
    let data = campaigns()[0].to_str().expect("a path in Unicode").to_owned();
    let plain = fs::read_to_string(report(folder.path(), &campaigns()[0])).expect("written");
    assert!(!plain.contains("id=\"ladder\"") && !plain.contains("id=\"diagnosis\""));
    let add = ["add", "model.toml", "thermal-lag", &data, "-o", "lag.toml"];
    // There is no lag in it.
    tempco(folder.path()).args(add).assert().code(1);
    let compare = ["compare", "lag.toml", &data, "--report", "lag.html", "--diagnose"];
    tempco(folder.path()).args(compare).assert().success();
    let html = fs::read_to_string(folder.path().join("lag.html")).expect("written");
    for needed in ["id=\"ladder\"", "+ thermal-lag", "network alone", "id=\"diagnosis\"", "this campaign can't show"] {
        assert!(html.replace("&#39;", "'").to_lowercase().contains(needed), "{needed}");
    }
    tempco(folder.path()).args(["compare", "lag.toml", &data, "--diagnose"]).assert().code(2);
}

#[test]
fn the_report_says_where_it_comes_from_and_what_each_figure_is() {
    let folder = TempDir::new().expect("a folder");
    let html = fs::read_to_string(report(folder.path(), &campaigns()[0])).expect("written");
    let model = fs::read_to_string(folder.path().join("model.toml")).expect("written");
    let hash = model.lines().find_map(|line| line.strip_prefix("campaign = \"")).expect("a hash").trim_end_matches('"');
    assert!(html.contains(hash), "the campaign's hash");
    assert!(html.contains(campaigns()[0].file_name().expect("a name").to_str().expect("Unicode")), "the data file");
    for definition in [
        "<dt>Z2 from the start</dt>",
        "<dt>Z4 (drift removed)</dt>",
        "<dt>Z6 (Allan minimum)</dt>",
        "eq. 12",
        "held out",
        "seed 1",
    ] {
        assert!(html.contains(definition), "{definition}");
    }
}

/// The data that the charts of a report are drawn from.
fn data(html: &str) -> serde_json::Value {
    let (_, rest) = html.split_once("id=\"data\">").expect("data");
    let (json, _) = rest.split_once("</script>").expect("its end");
    serde_json::from_str(json).expect("JSON")
}

#[test]
fn no_mark_lies_outside_its_axes() {
    for campaign in campaigns() {
        let folder = TempDir::new().expect("a folder");
        let html = fs::read_to_string(report(folder.path(), &campaign)).expect("written");
        let data = data(&html);
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            value.as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect()
        };
        let mut checked = 0;
        for chart in data["charts"].as_array().expect("charts") {
            for layer in chart["layers"].as_array().expect("layers").iter().filter(|layer| layer["mark"] == "dots") {
                for axis in ["x", "y"] {
                    let range = numbers(&chart[axis]["range"]);
                    let inside = |value: &f64| (range[0]..=range[1]).contains(value);
                    assert!(numbers(&layer[axis]).iter().all(inside), "{}, {axis}", chart["id"]);
                    checked += 1;
                }
            }
        }
        assert!(checked > 10, "{checked} layers");
        assert!(data["runs"].as_array().is_some_and(|runs| runs.iter().any(|run| run["held_out"] == true)));
    }
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

#[test]
fn what_foreign_names_would_hide_or_turn_around_is_seen_in_the_report_without_a_browser() {
    let folder = TempDir::new().expect("a folder");
    let name = "a\u{1b}[31m\u{202e}<b>";
    let small = fs::read_to_string(&campaigns()[0]).expect("checked in").replace("full-2,", &format!("\"{name}\","));
    fs::write(folder.path().join("c.csv"), small).expect("written");
    let text = fs::read_to_string(report(folder.path(), Path::new("c.csv"))).expect("written");
    let (page, _) = text.split_once("<script type=\"application/json\"").expect("numbers after the page");
    assert!(page.contains("a\\u{1b}[31m\\u{202e}&lt;b&gt;"), "the name is shown");
    assert!(!page.contains('\u{1b}') && !page.contains('\u{202e}'));
}
