//! The loop without a mouse: everything can be reached by Tab and pressed by Enter, and what is reached can be seen.

use super::chromium::Chromium;
use super::page::{assert_silent, lit, open, rest, until};
use super::served::Served;
use serde_json::json;

/// Goes on by Tab until this element is reached.
fn reach(browser: &mut Chromium, id: &str) {
    until(
        browser,
        &format!("Boolean(document.getElementById({0})) && !document.getElementById({0}).disabled", json!(id)),
    );
    for _ in 0..120 {
        if browser.evaluate("document.activeElement.id") == json!(id) {
            let seen = browser.evaluate("getComputedStyle(document.activeElement).outlineStyle !== 'none'");
            assert_eq!(seen, json!(true), "nobody sees that {id} is reached");
            return;
        }
        browser.key("Tab");
    }
    panic!("no Tab leads to {id}");
}

fn press(browser: &mut Chromium, id: &str) {
    reach(browser, id);
    browser.key("Enter");
}

#[test]
fn the_loop_can_be_gone_by_keys_alone() {
    let served = Served::small();
    let mut browser = open(&served, "light");
    browser.key("Tab");
    assert_eq!(browser.evaluate("document.activeElement.textContent"), json!("Skip to the step"));
    browser.key("Enter");
    assert_eq!(browser.evaluate("document.activeElement.id"), json!("main"));
    press(&mut browser, "step-train");
    assert_eq!(browser.evaluate("document.activeElement.id"), json!("main"), "a step's own things come next");
    press(&mut browser, "train");
    until(&mut browser, "document.getElementById('linked').hidden === false");
    until(&mut browser, "document.querySelector('[data-column=temperature_c] .base').width > 0");
    for _ in 0..120 {
        if browser.evaluate("document.activeElement.dataset.column === 'temperature_c'") == json!(true) {
            break;
        }
        browser.key("Tab");
    }
    browser.key("Enter");
    for _ in 0..4 {
        browser.key("ArrowLeft");
    }
    until(&mut browser, "/ of 2736 samples|of 2.736 samples/.test(document.querySelector('.chosen').textContent)");
    assert!(lit(&mut browser, "time_h") > 0);
    browser.key("Escape");
    assert_eq!(lit(&mut browser, "time_h"), 0);
    for (step, button, answer) in [
        ("step-diagnose", "diagnose", ".verdict"),
        ("step-export", "export", "#download-hex"),
        ("step-verify", "verify", ".verdict"),
    ] {
        press(&mut browser, step);
        press(&mut browser, button);
        until(&mut browser, &format!("Boolean(document.querySelector('{answer}'))"));
        rest(&mut browser);
    }
    until(&mut browser, "document.querySelector('.verdict')?.textContent.includes('identical in every bit') === true");
    let told = browser.evaluate("document.getElementById('activity').getAttribute('aria-live')");
    assert_eq!(told, json!("polite"));
    assert_silent(&browser);
}
