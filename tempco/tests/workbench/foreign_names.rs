//! What strangers wrote into names is text on the page: it runs nothing, hides nothing, turns nothing around.

use super::page::{assert_silent, click, open, rest, shoot, until};
use super::served::{SMALL, Served};
use serde_json::json;
use std::fs;
use tempfile::TempDir;

#[test]
fn markup_and_control_characters_of_names_are_shown_as_they_are() {
    let folder = TempDir::new().expect("a folder");
    let run = "<img src=x onerror=alert(1)>\u{1b}[31m\u{202e}dab";
    let small = fs::read_to_string(SMALL).expect("checked in").replace("full-2,", &format!("\"{run}\","));
    let name = "<b>bold\u{202e}.csv";
    fs::write(folder.path().join(name), small).expect("written");
    let served = Served::start_in(folder, &[name]);
    served.settled();
    served.done("train", r#"{"restarts":1}"#);
    let mut browser = open(&served, "light");
    for step in ["load", "train", "compare"] {
        click(&mut browser, &format!("#step-{step}"));
        let shown = browser.evaluate("document.body.textContent");
        let shown = shown.as_str().expect("text");
        assert!(shown.contains("<img src=x onerror=alert(1)>\\u{1b}[31m\\u{202e}dab"), "{step}: {shown}");
        assert!(!shown.contains('\u{1b}') && !shown.contains('\u{202e}'), "{step}");
        assert_eq!(browser.evaluate("document.querySelectorAll('main img, main b').length"), json!(0), "{step}");
    }
    assert!(
        browser
            .evaluate("document.getElementById('subject').textContent")
            .as_str()
            .is_some_and(|subject| { subject.starts_with("<b>bold\\u{202e}.csv") })
    );
    assert_silent(&browser);
}

#[test]
fn a_file_that_is_dropped_sets_the_models_aside_and_a_click_brings_them_back() {
    let served = Served::small();
    served.done("train", r#"{"restarts":1}"#);
    let mut browser = open(&served, "light");
    let text = fs::read_to_string(SMALL).expect("checked in");
    browser.evaluate(&format!(
        "(() => {{ const files = new DataTransfer(); files.items.add(new File([{}], 'second.csv')); \
         document.body.dispatchEvent(new DragEvent('drop', {{ dataTransfer: files, bubbles: true, cancelable: true }})); }})()",
        json!(text)
    ));
    until(&mut browser, "document.getElementById('subject').textContent.includes('second.csv')");
    rest(&mut browser);
    until(&mut browser, "document.getElementById('activity').textContent.includes('is kept, with its model 1')");
    click(&mut browser, "#train");
    until(&mut browser, "document.getElementById('subject').textContent.includes('model 2')");
    rest(&mut browser);
    assert!(served.path("model-2.toml").exists());
    click(&mut browser, "#step-load");
    shoot(&mut browser, "two-campaigns.png");
    browser.screen(400, 800, "light");
    shoot(&mut browser, "two-campaigns-narrow.png");
    let overflow = browser.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth");
    assert_eq!(overflow, json!(0), "the page is wider than a telephone");
    click(&mut browser, "#campaign-1");
    until(&mut browser, "document.getElementById('subject').textContent.includes('small.csv · model 1')");
    assert_silent(&browser);
}
