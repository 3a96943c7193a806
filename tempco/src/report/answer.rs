//! The top of the report: the verdict, what speaks against it, the figures of merit.

use super::table::{Column, Table, figure, fixed};
use crate::page::escaped;
use std::fmt::Write;
use trainer::metrics::{allan, allan_model};
use trainer::report::{Merit, Report};
use trainer::sensitivity;

/// The verdict in a sentence, and what the reader should know before believing it.
pub fn verdict(report: &Report) -> String {
    let state = if report.verdict.sound { "sound" } else { "unsound" };
    let mut text = format!("<p class=\"verdict {state}\">{}</p>\n", escaped(&report.verdict.sentence));
    if !report.comparison.warnings.is_empty() {
        let items =
            report.comparison.warnings.iter().map(|warning| format!("<li>{}</li>\n", escaped(&sentence(warning))));
        let _ = writeln!(text, "<p>Before relying on it:</p>\n<ul>\n{}</ul>", items.collect::<String>());
    }
    text
}

/// With a capital letter and a full stop; a formula keeps its own letters.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map_or(String::new(), |letter| letter.to_ascii_uppercase().to_string());
    format!("{first}{}.", letters.as_str())
}

/// Figures before and after.
pub fn merits(report: &Report) -> String {
    let rows = if report.comparison.held_out { "held-out runs" } else { "all runs; none was held out" };
    let columns = [
        Column::Text("figure"),
        Column::Text("run"),
        Column::Figure("raw"),
        Column::Figure("compensated"),
        Column::Text("unit"),
        Column::Figure("times better"),
    ];
    let mut table = Table::new(&format!("Before and after, on {rows}. Raw is a straight line through Δf."), columns);
    for merit in &report.merits {
        let cells = [
            merit.name.clone(),
            merit.run.clone().unwrap_or_else(|| "all".to_owned()),
            figure(merit.raw),
            figure(merit.compensated),
            merit.unit.clone(),
            better(merit),
        ];
        if merit.run.is_none() { table.marked_row(cells) } else { table.row(cells) }
    }
    table.to_string()
}

fn better(merit: &Merit) -> String {
    let ratio = (merit.raw / merit.compensated).abs();
    if !ratio.is_finite() {
        return "—".to_owned();
    }
    format!("{}×", fixed(ratio, usize::from(ratio < 10.0)))
}

/// What every figure and chart means, each definition once with all the figures that it defines.
pub fn definitions(report: &Report) -> String {
    let mut defined: Vec<(&str, Vec<&str>)> = Vec::new();
    for merit in &report.merits {
        match defined.iter_mut().find(|(definition, _)| *definition == merit.definition) {
            Some((_, names)) if names.contains(&merit.name.as_str()) => {}
            Some((_, names)) => names.push(&merit.name),
            None => defined.push((&merit.definition, vec![&merit.name])),
        }
    }
    defined.extend([
        (allan::DEFINITION, vec!["Allan deviation"]),
        (allan_model::DEFINITION, vec!["Fitted noise"]),
        (sensitivity::DEFINITION, vec!["Error of the local slope"]),
        (NOISE, vec!["Noise from sample to sample"]),
    ]);
    let each = defined.iter().map(|(definition, names)| {
        let definition = sentence(definition.trim_end_matches('.'));
        format!("<dt>{}</dt><dd>{}</dd>\n", escaped(&names.join(", ")), escaped(&definition))
    });
    format!("<dl>\n{}</dl>\n", each.collect::<String>())
}

const NOISE: &str = "from differences of neighbouring samples at one level: what no model could remove";
