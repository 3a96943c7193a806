//! The page in a browser: where things are, and hands to press them.

use super::chromium::Chromium;
use super::served::Served;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Ten minutes of looks: a busy machine may take so long for the longest piece of work.
const LOOKS: u32 = 10_000;
const LOOK: Duration = Duration::from_millis(60);

/// Where pictures are kept for people to look at.
fn picture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("workbench").join(name)
}

/// A picture of the whole page, from its top.
pub fn shoot(browser: &mut Chromium, name: &str) {
    browser.evaluate("window.scrollTo(0, 0)");
    browser.screenshot(&picture(name));
}

/// Opens the workbench's own address.
pub fn open(served: &Served, scheme: &str) -> Chromium {
    let mut browser = Chromium::start();
    browser.screen(1440, 900, scheme);
    browser.visit(&served.url);
    until(&mut browser, "document.querySelectorAll('.step').length === 8");
    browser
}

/// Waits as long as work may take.
pub fn until(browser: &mut Chromium, expression: &str) {
    for _ in 0..LOOKS {
        if browser.evaluate(expression) == json!(true) {
            return;
        }
        std::thread::sleep(LOOK);
    }
    let seen = browser.evaluate("document.querySelector('main').innerText.slice(0, 600)");
    panic!("never true: {expression}\n{seen}");
}

/// Waits until no work goes on.
pub fn rest(browser: &mut Chromium) {
    until(browser, "!document.body.classList.contains('busy')");
}

/// The middle of an element on the screen, once it is there and can be pressed.
pub fn middle(browser: &mut Chromium, selector: &str) -> (f64, f64) {
    let found = format!("document.querySelector({})", json!(selector));
    until(browser, &format!("Boolean({found}) && !{found}.disabled && {found}.getBoundingClientRect().width > 0"));
    let place = browser.evaluate(&format!(
        "(() => {{ {found}.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
         const box = {found}.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; }})()"
    ));
    (place[0].as_f64().expect("a number"), place[1].as_f64().expect("a number"))
}

/// Presses an element with the mouse, where nothing lies over it.
pub fn click(browser: &mut Chromium, selector: &str) {
    let (x, y) = middle(browser, selector);
    let on_top = format!("document.querySelector({}).contains(document.elementFromPoint({x}, {y}))", json!(selector));
    assert_eq!(browser.evaluate(&on_top), json!(true), "something lies over {selector}");
    for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
        browser.mouse(kind, x, y);
    }
}

/// Chooses an option of a list.
pub fn choose(browser: &mut Chromium, selector: &str, value: &str) {
    middle(browser, selector);
    let list = format!("document.querySelector({})", json!(selector));
    browser.evaluate(&format!(
        "{list}.value = {}; {list}.dispatchEvent(new Event('change', {{ bubbles: true }})); true",
        json!(value)
    ));
}

/// Drags a region of a plot, given in parts of its box, in so many steps.
pub fn brush(browser: &mut Chromium, column: &str, from: (f64, f64), to: (f64, f64), steps: u32) {
    let selector = format!("[data-column={column}]");
    middle(browser, &selector);
    let found = browser.evaluate(&format!(
        "(() => {{ const box = document.querySelector({}).getBoundingClientRect(); return [box.x, box.y, box.width, box.height]; }})()",
        json!(selector)
    ));
    let [x, y, width, height] = [0, 1, 2, 3].map(|k| found[k].as_f64().expect("a number"));
    let at = |(part_x, part_y): (f64, f64)| (x + part_x * width, y + part_y * height);
    let ((x0, y0), (x1, y1)) = (at(from), at(to));
    browser.mouse("mouseMoved", x0, y0);
    browser.mouse("mousePressed", x0, y0);
    for step in 1..=steps {
        let part = f64::from(step) / f64::from(steps);
        browser.mouse("mouseMoved", x0 + part * (x1 - x0), y0 + part * (y1 - y0));
    }
    browser.mouse("mouseReleased", x1, y1);
}

/// How many samples are lit in a plot, in pixels.
pub fn lit(browser: &mut Chromium, column: &str) -> u64 {
    let pixels = format!(
        "(() => {{ const canvas = document.querySelector('[data-column={column}] .lit'); \
         const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data; \
         let count = 0; for (let k = 3; k < data.length; k += 4) if (data[k]) count += 1; return count; }})()"
    );
    browser.evaluate(&pixels).as_u64().expect("a number")
}

/// The console stayed silent.
pub fn assert_silent(browser: &Chromium) {
    assert!(browser.complaints().is_empty(), "{:#?}", browser.complaints());
}
