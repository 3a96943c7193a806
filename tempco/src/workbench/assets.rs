//! The page's own files. They hold no secret and are the same for everybody.

use crate::page;

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";
const PICTURE: &str = "image/svg+xml";

/// Path, type and content.
pub const ALL: &[(&str, &str, &str)] = &[
    ("/", HTML, include_str!("assets/index.html")),
    ("/icon.svg", PICTURE, include_str!("assets/icon.svg")),
    ("/style.css", STYLE, page::STYLE),
    ("/workbench.css", STYLE, include_str!("assets/workbench.css")),
    ("/charts.js", SCRIPT, page::SCRIPT),
    ("/app.js", SCRIPT, include_str!("assets/app.js")),
    ("/api.js", SCRIPT, include_str!("assets/api.js")),
    ("/dom.js", SCRIPT, include_str!("assets/dom.js")),
    ("/guide.js", SCRIPT, include_str!("assets/guide.js")),
    ("/linked.js", SCRIPT, include_str!("assets/linked.js")),
    ("/reports.js", SCRIPT, include_str!("assets/reports.js")),
    ("/scatter.js", SCRIPT, include_str!("assets/scatter.js")),
    ("/steps/load.js", SCRIPT, include_str!("assets/steps/load.js")),
    ("/steps/train.js", SCRIPT, include_str!("assets/steps/train.js")),
    ("/steps/compare.js", SCRIPT, include_str!("assets/steps/compare.js")),
    ("/steps/diagnose.js", SCRIPT, include_str!("assets/steps/diagnose.js")),
    ("/steps/add.js", SCRIPT, include_str!("assets/steps/add.js")),
    ("/steps/export.js", SCRIPT, include_str!("assets/steps/export.js")),
    ("/steps/verify.js", SCRIPT, include_str!("assets/steps/verify.js")),
    ("/steps/plan.js", SCRIPT, include_str!("assets/steps/plan.js")),
];
