//! The tables of the report: runs, ladder, provenance.

use super::table::{Column, Table, figure, fixed};
use crate::page::escaped;
use std::fmt::Write;
use trainer::compare::RunComparison;
use trainer::ladder::Rung;
use trainer::report::{Origin, Report};

/// Run by run.
pub fn runs(report: &Report) -> String {
    let columns = [
        Column::Text("run"),
        Column::Text("kind"),
        Column::Text("seen"),
        Column::Figure("samples"),
        Column::Figure("residual, µg"),
        Column::Figure("mean, µg"),
        Column::Figure("about mean, µg"),
        Column::Figure("flagged"),
    ];
    let mut table =
        Table::new("Root mean square of reading minus reference, run by run. Held-out runs are marked.", columns);
    for run in &report.comparison.runs {
        let cells = run_cells(run);
        if run.held_out { table.marked_row(cells) } else { table.row(cells) }
    }
    let note = "Mean is the run's own offset; flagged readings lie outside the calibrated domain, are stale or faulty.";
    format!("{table}<p class=\"note\">{note}</p>\n")
}

fn run_cells(run: &RunComparison) -> [String; 8] {
    [
        run.run.clone(),
        run.kind.clone(),
        if run.held_out { "held out".to_owned() } else { "training".to_owned() },
        run.samples.to_string(),
        fixed(run.residual_ug, 2),
        fixed(run.mean_ug, 2),
        fixed(run.about_mean_ug, 2),
        run.flagged.to_string(),
    ]
}

/// What each effect is worth, down to the noise; empty for a model without effects.
pub fn ladder(report: &Report) -> String {
    if report.ladder.is_empty() {
        return String::new();
    }
    let highest = report.ladder.iter().map(|rung| rung.residual_ug).fold(0.0, f64::max);
    let columns = [Column::Text("model"), Column::Figure("held-out residual, µg"), Column::Text("")];
    let mut table = Table::new("Each rung trained as this model was, with one effect more.", columns);
    let mut row = |name: &str, residual_ug: f64| {
        let bar = format!("<div class=\"bar\" style=\"width: {:.1}%\"></div>", residual_ug / highest * 100.0);
        table.row_of_html([escaped(name), figure(residual_ug), bar]);
    };
    for (index, Rung { effect, residual_ug }) in report.ladder.iter().enumerate() {
        row(&if index == 0 { effect.clone() } else { format!("+ {effect}") }, *residual_ug);
    }
    if let Some(noise_ug) = report.comparison.noise_floor_ug {
        row("noise from sample to sample", noise_ug);
    }
    format!("<h2 id=\"ladder\">What each effect is worth</h2>\n{table}")
}

/// Where everything came from.
pub fn origin(origin: &Origin) -> String {
    let model = &origin.model;
    let same =
        if origin.same_campaign { "the one that the model was trained on" } else { "another one than the model's" };
    let facts = [
        ("Sensor", if origin.serial.is_empty() { "no serial number stated".to_owned() } else { origin.serial.clone() }),
        ("Model", format!("fingerprint {}, made by {}", origin.fingerprint, model.made_by)),
        ("Method", format!("{}, seed {}, best of {} restarts", model.method, model.seed, model.restarts)),
        ("Trained on", model.training_runs.join(", ")),
        (
            "Held out",
            if model.held_out_runs.is_empty() { "nothing".to_owned() } else { model.held_out_runs.join(", ") },
        ),
        ("Residual in training", format!("{} µg RMS", figure(model.training_residual * 1e6))),
        ("Model's campaign", format!("SHA-256 {}", model.campaign)),
        ("This campaign", format!("SHA-256 {}, {} rows; {same}", origin.campaign, fixed(origin.rows as f64, 0))),
        ("Report", origin.reported_by.clone()),
    ];
    let mut text = String::from("<dl class=\"facts\">\n");
    for (name, value) in facts {
        let _ = writeln!(text, "<dt>{name}</dt><dd>{}</dd>", escaped(&value));
    }
    for effect in &origin.effects {
        let values = effect.parameters.iter().map(|(name, value)| format!("{name} = {value:.4e}"));
        let values = values.collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "<dt>Effect</dt><dd>{}: {}</dd>", escaped(effect.title()), escaped(&values));
    }
    text += "</dl>\n";
    if origin.files.is_empty() {
        return text;
    }
    let mut table = Table::new("Data files", [Column::Text("file"), Column::Text("SHA-256")]);
    for file in &origin.files {
        table.row_of_html([escaped(&file.name), format!("<code>{}</code>", file.sha256)]);
    }
    text + &table.to_string()
}
