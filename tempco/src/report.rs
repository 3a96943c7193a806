//! A report as one HTML file that needs nothing else: style, charts and numbers are in it.

mod answer;
mod details;
mod diagnosis;
mod table;

use crate::output::GENERATOR;
use crate::page::{SCRIPT, STYLE, embedded_json, escaped};
use serde_json::json;
use trainer::report::{Chart, Report, Section};

/// Draws what the file holds.
const START: &str = include_str!("report/start.js");
/// What only the report has.
const REPORT_STYLE: &str = include_str!("report/report.css");

/// The whole file. The same report gives the same bytes.
pub fn html(report: &Report) -> serde_json::Result<String> {
    let charts: Vec<&Chart> = report.sections.iter().flat_map(|section| &section.charts).collect();
    let data = embedded_json(&json!({ "runs": report.runs, "charts": charts }))?;
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"generator\" content=\"{GENERATOR}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Compensation report {title}</title>\n<style>\n{STYLE}{REPORT_STYLE}</style>\n</head>\n\
         <body>\n<main>\n{main}</main>\n\
         <script type=\"application/json\" id=\"data\">{data}</script>\n<script>\n{SCRIPT}{START}</script>\n\
         </body>\n</html>\n",
        title = escaped(name(report)),
        main = main(report),
    ))
}

/// The sensor's serial number, or else what its calibration is known by.
fn name(report: &Report) -> &str {
    let origin = &report.origin;
    if origin.serial.is_empty() { &origin.fingerprint } else { &origin.serial }
}

fn main(report: &Report) -> String {
    let diagnosis = report.diagnosis.as_ref().map(diagnosis::section).unwrap_or_default();
    let parts = [
        header(report),
        answer::verdict(report),
        contents(report),
        heading("merits", "Figures of merit"),
        answer::merits(report),
        report.sections.iter().map(section).collect(),
        heading("runs", "Run by run"),
        details::runs(report),
        details::ladder(report),
        diagnosis,
        heading("definitions", "What the figures are"),
        answer::definitions(report),
        heading("origin", "Where this comes from"),
        details::origin(&report.origin),
        FOOTER.to_owned(),
    ];
    parts.concat()
}

const FOOTER: &str = "<footer class=\"hint\">In a chart, the pointer or the arrow keys read a mark, dragging magnifies, \
    Escape or a double click goes back. <noscript>This browser runs no scripts: the charts are left out, all figures \
    stand in the tables.</noscript></footer>\n";

fn header(report: &Report) -> String {
    let comparison = &report.comparison;
    let held_out = comparison.runs.iter().filter(|run| run.held_out).count();
    format!(
        "<header><h1>Temperature compensation: {}</h1>\n<p>{} rows in {} runs, {held_out} of them held out; readings in \
         the device's own arithmetic.</p></header>\n",
        escaped(name(report)),
        table::fixed(report.origin.rows as f64, 0),
        comparison.runs.len(),
    )
}

fn contents(report: &Report) -> String {
    let fixed = |id: &'static str, title: &'static str, there: bool| there.then_some((id, title));
    let links = std::iter::once(("merits", "Figures of merit"))
        .chain(report.sections.iter().map(|section| (section.id, section.title)))
        .chain(fixed("runs", "Run by run", true))
        .chain(fixed("ladder", "What each effect is worth", !report.ladder.is_empty()))
        .chain(fixed("diagnosis", "Diagnosis", report.diagnosis.is_some()))
        .chain(fixed("definitions", "What the figures are", true))
        .chain(fixed("origin", "Where this comes from", true))
        .map(|(id, title)| format!("<li><a href=\"#{id}\">{title}</a></li>"));
    format!("<nav aria-label=\"Contents\"><ul>{}</ul></nav>\n", links.collect::<String>())
}

fn heading(id: &str, title: &str) -> String {
    format!("<h2 id=\"{id}\">{title}</h2>\n")
}

fn section(section: &Section) -> String {
    let figures: String = section.charts.iter().map(figure).collect();
    format!("{}<div class=\"charts\">\n{figures}</div>\n", heading(section.id, section.title))
}

fn figure(chart: &Chart) -> String {
    let (id, title, caption) = (escaped(&chart.id), escaped(&chart.title), escaped(&chart.caption));
    format!(
        "<figure id=\"{id}\"><h3>{title}</h3>\n<div class=\"chart\"></div>\n<figcaption>{caption}</figcaption></figure>\n"
    )
}
