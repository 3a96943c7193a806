//! The diagnosis with its ΔBIC.

use super::table::{Column, Table, figure};
use crate::page::escaped;
use crate::render::diagnosis::{parameters, verdict};
use firmware_core::effect::about;
use std::fmt::Write;
use trainer::diagnose::{Diagnosis, Finding, Judged, LEAST_DELTA_BIC};

/// What is missing, how sure that is, and what the campaign can't show.
pub fn section(diagnosis: &Diagnosis) -> String {
    let mut text = String::from("<h2 id=\"diagnosis\">Diagnosis</h2>\n");
    for line in verdict(diagnosis).lines() {
        let _ = writeln!(text, "<p>{}</p>", escaped(line));
    }
    if !diagnosis.findings.is_empty() {
        text += &findings(&diagnosis.findings);
    }
    if !diagnosis.dependences.is_empty() {
        text += &dependences(diagnosis);
    }
    if !diagnosis.candidates.is_empty() {
        text += &candidates(&diagnosis.candidates);
    }
    if !diagnosis.unobservable.is_empty() {
        let mut table = Table::new("What this campaign can't show", [Column::Text("effect"), Column::Text("why")]);
        for one in &diagnosis.unobservable {
            table.row([one.effect.clone(), one.why.clone()]);
        }
        text += &table.to_string();
    }
    text
}

fn candidates(all: &[Judged]) -> String {
    let columns = [
        Column::Text("effect"),
        Column::Figure("ΔBIC"),
        Column::Figure("held-out ratio"),
        Column::Text("what came of it"),
    ];
    let mut table = Table::new("Every effect that was judged", columns);
    for one in all {
        let ratio = one.held_out_ratio.map_or_else(String::new, |ratio| format!("{ratio:.3}"));
        table.row([one.effect.clone(), format!("{:.0}", one.delta_bic), ratio, one.outcome.reason()]);
    }
    table.to_string()
}

fn findings(findings: &[Finding]) -> String {
    let columns = [
        Column::Text("effect, in the order to add"),
        Column::Figure("held-out before, µg"),
        Column::Figure("after, µg"),
        Column::Figure("ΔBIC"),
        Column::Text("parameters"),
        Column::Text("would explain the same"),
    ];
    let caption = format!(
        "ΔBIC is twice the log likelihood ratio, less ln n for each parameter; an effect needs {LEAST_DELTA_BIC:.0}."
    );
    let mut table = Table::new(&caption, columns);
    for finding in findings {
        table.row([
            finding.effect.clone(),
            figure(finding.residual_before_ug),
            figure(finding.residual_after_ug),
            format!("{:.0}", finding.delta_bic),
            parameters(finding).join(", "),
            finding.confounded_with.join(", "),
        ]);
    }
    let explained = findings.iter().filter_map(|finding| {
        let about = about(&finding.effect)?;
        let experiment = finding.separate_by.as_ref().map(|text| format!(" To tell them apart: {text}"));
        let words = format!("{} {}.{}", about.summary, about.equation, experiment.unwrap_or_default());
        Some(format!("<dt>{}</dt><dd>{}</dd>\n", escaped(&finding.effect), escaped(&words)))
    });
    format!("{table}<dl>\n{}</dl>\n", explained.collect::<String>())
}

fn dependences(diagnosis: &Diagnosis) -> String {
    let columns = [
        Column::Text("residual that follows"),
        Column::Figure("before, µg"),
        Column::Figure("chance"),
        Column::Figure("after, µg"),
        Column::Figure("chance"),
    ];
    let caption = "How much of the residual follows each quantity, before and after the findings, noise deducted, and \
                   the probability of as much by chance.";
    let mut table = Table::new(caption, columns);
    let chance =
        |probability: f64| if probability < 1e-4 { "< 0.0001".to_owned() } else { format!("{probability:.4}") };
    for one in &diagnosis.dependences {
        table.row([
            one.on.clone(),
            figure(one.before_ug),
            chance(one.chance_before),
            figure(one.after_ug),
            chance(one.chance_after),
        ]);
    }
    table.to_string()
}
