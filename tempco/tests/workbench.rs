//! The workbench: what it answers, whom it answers, and the whole loop by clicks and by keys.

#[path = "../../tests/browser/chromium.rs"]
#[allow(dead_code, reason = "other pages need more of a browser")]
mod chromium;
#[path = "workbench/clicks.rs"]
mod clicks;
#[path = "workbench/foreign_names.rs"]
mod foreign_names;
#[path = "workbench/kept.rs"]
mod kept;
#[path = "workbench/keys.rs"]
mod keys;
#[path = "workbench/page.rs"]
mod page;
#[path = "workbench/requests.rs"]
mod requests;
#[path = "workbench/served.rs"]
mod served;
#[cfg(unix)]
#[path = "workbench/shell.rs"]
mod shell;
#[path = "workbench/strangers.rs"]
mod strangers;
#[path = "workbench/uploads.rs"]
mod uploads;
