//! The page's own files. They hold no secret and are the same for everybody.

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";

/// Path, type and content.
pub const ALL: &[(&str, &str, &str)] = &[
    ("/", HTML, include_str!("assets/index.html")),
    ("/app.js", SCRIPT, include_str!("assets/app.js")),
    ("/workbench.css", STYLE, include_str!("assets/workbench.css")),
];
