//! Progress bars, on a terminal only, and cancelling with Ctrl-C.

use crate::visible::visible_word;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::Duration;
use trainer::progress::{Progress, RestartNews};

/// A bar over something that takes a while; none when nobody watches.
pub fn bar(length: u64, what: &str) -> ProgressBar {
    if !watched() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{prefix:>12} [{bar:30}] {pos}/{len} {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style.progress_chars("=> ")).with_prefix(visible_word(what).into_owned())
}

/// Something that takes a while, nobody knows how long; nothing when nobody watches.
pub fn spinner(what: &str) -> ProgressBar {
    if !watched() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{prefix:>12} {spinner}").unwrap_or_else(|_| ProgressStyle::default_bar());
    let spinner = ProgressBar::new_spinner().with_style(style).with_prefix(visible_word(what).into_owned());
    spinner.enable_steady_tick(Duration::from_millis(120));
    spinner
}

fn watched() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("CI").is_none()
}

/// Shows the restarts of a training.
pub struct Restarts {
    bar: ProgressBar,
    best_g: Mutex<f64>,
}

impl Restarts {
    pub fn new(restarts: usize, what: &str) -> Self {
        Self { bar: bar(restarts as u64, what), best_g: Mutex::new(f64::INFINITY) }
    }
}

impl Progress for Restarts {
    fn restart(&self, news: RestartNews) {
        if !news.done || self.bar.position() >= self.bar.length().unwrap_or(0) {
            return;
        }
        self.bar.inc(1);
        if let Ok(mut best_g) = self.best_g.lock() {
            *best_g = best_g.min(news.residual_g);
            self.bar.set_message(format!("best {:.2} µg", *best_g * 1e6));
        }
    }
}

impl Drop for Restarts {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
