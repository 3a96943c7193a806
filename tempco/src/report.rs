//! A report as one HTML file that needs nothing else: style, charts and numbers are in it.

use crate::page::{SCRIPT, STYLE, embedded_json, escaped};
use serde_json::json;
use std::fmt::Write;
use trainer::report::{Chart, Report};

/// The whole file.
pub fn html(report: &Report) -> serde_json::Result<String> {
    let data = embedded_json(&json!({ "runs": report.runs, "charts": report.charts }))?;
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{main}</main>\n\
         <script type=\"application/json\" id=\"data\">{data}</script>\n<script>\n{SCRIPT}{START}</script>\n</body>\n</html>\n",
        title = escaped("Compensation report"),
        main = report.charts.iter().map(figure).collect::<String>(),
    ))
}

/// Draws what the file holds.
const START: &str = include_str!("report/start.js");

fn figure(chart: &Chart) -> String {
    let mut text = String::new();
    let (id, title, caption) = (escaped(&chart.id), escaped(&chart.title), escaped(&chart.caption));
    let _ = writeln!(
        text,
        "<figure id=\"{id}\"><h3>{title}</h3><div class=\"chart\"></div><figcaption>{caption}</figcaption></figure>"
    );
    text
}
