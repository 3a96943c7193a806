//! Results as text for people.

pub mod diagnosis;
pub mod plan;
pub mod status;

use crate::table::Table;
use std::fmt::Write;
use trainer::compare::{Comparison, Figures, RunFigures};
use trainer::cross_validation::{self, CrossValidation};
use trainer::metrics::{allan, full_temperature, zero_bias};
use trainer::sensitivity;

/// A comparison: the answer first, then run by run, then the figures of merit with their definitions.
pub fn comparison(comparison: &Comparison) -> String {
    let mut text = headline(comparison);
    text += "\n";
    text += &runs(comparison).to_string();
    text += &figures(&comparison.figures);
    text
}

/// A cross-validation: level by level, temperature by temperature.
pub fn cross_validation(validation: &CrossValidation) -> String {
    let mut text = String::new();
    let parts = [
        ("Left-out level g", validation.levels_ug, &validation.by_level),
        ("Left-out temperature °C", validation.temperatures_ug, &validation.by_temperature),
    ];
    for (title, pooled_ug, left_out) in parts {
        let Some(pooled_ug) = pooled_ug else { continue };
        let mut table = Table::new([title, "samples", "residual µg"]);
        for one in left_out {
            table.row([format!("{:+.2}", one.at), one.samples.to_string(), format!("{:.2}", one.residual_ug)]);
        }
        table.row(["all".to_owned(), String::new(), format!("{pooled_ug:.2}")]);
        let _ = writeln!(text, "{table}");
    }
    text + "  " + cross_validation::DEFINITION
}

fn headline(comparison: &Comparison) -> String {
    let seen = if comparison.held_out { "on runs that the training never saw" } else { "on the training runs" };
    let mut text = format!("Residual {:.2} µg RMS {seen}", comparison.residual_ug);
    if let Some(floor) = comparison.noise_floor_ug {
        let _ = write!(text, "; noise from sample to sample {floor:.2} µg");
    }
    text += ".\n";
    if let Some(sensitivity) = comparison.sensitivity_ppm {
        let _ = writeln!(
            text,
            "Local slope within {:.0} ppm of the measured scale factor everywhere in the calibrated domain (RMS {:.0} ppm).",
            sensitivity.worst, sensitivity.rms
        );
    }
    for warning in &comparison.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

fn runs(comparison: &Comparison) -> Table {
    let mut table =
        Table::new(["run", "kind", "seen", "samples", "residual µg", "mean µg", "about mean µg", "flagged"]);
    for run in &comparison.runs {
        table.row([
            run.run.clone(),
            run.kind.clone(),
            if run.held_out { "held out".to_owned() } else { "training".to_owned() },
            run.samples.to_string(),
            format!("{:.2}", run.residual_ug),
            format!("{:+.2}", run.mean_ug),
            format!("{:.2}", run.about_mean_ug),
            run.flagged.to_string(),
        ]);
    }
    table
}

fn figures(figures: &[RunFigures]) -> String {
    let mut text = String::new();
    section(&mut text, "Zero-bias stability, µg", zero_bias::DEFINITION, zero_bias_table(figures));
    section(&mut text, "Over temperature", full_temperature::DEFINITION, temperature_table(figures));
    section(&mut text, "Allan deviation of the residual, µg", allan::DEFINITION, allan_table(figures));
    if !text.is_empty() {
        let _ = writeln!(text, "\nLocal slope: {}", sensitivity::DEFINITION);
    }
    text
}

fn section(text: &mut String, title: &str, definition: &str, table: Option<Table>) {
    if let Some(table) = table {
        let _ = write!(text, "\n{title}\n{table}  {definition}\n");
    }
}

fn pairs<'a, T>(figures: &'a [RunFigures], get: impl Fn(&'a Figures) -> Option<T>) -> Vec<(&'a RunFigures, T, T)> {
    figures.iter().filter_map(|run| Some((run, get(&run.raw)?, get(&run.compensated)?))).collect()
}

fn zero_bias_table(figures: &[RunFigures]) -> Option<Table> {
    let rows = pairs(figures, |figures| figures.zero_bias);
    let mut table = Table::new(["run", "raw: start", "20 min", "30 min", "compensated: start", "20 min", "30 min"]);
    for (run, raw, compensated) in &rows {
        let number = |value: f64| format!("{value:.2}");
        table.row([
            run.run.clone(),
            number(raw.from_start_ug),
            number(raw.after_20_min_ug),
            number(raw.after_30_min_ug),
            number(compensated.from_start_ug),
            number(compensated.after_20_min_ug),
            number(compensated.after_30_min_ug),
        ]);
    }
    (!rows.is_empty()).then_some(table)
}

fn temperature_table(figures: &[RunFigures]) -> Option<Table> {
    let rows = pairs(figures, |figures| figures.full_temperature.as_ref());
    let mut table = Table::new(["run", "", "K1 variation ppm", "K1 ppm/K", "bias variation µg", "bias µg/K"]);
    for (run, raw, compensated) in &rows {
        for (what, figures) in [("raw", raw), ("compensated", compensated)] {
            table.row([
                run.run.clone(),
                what.to_owned(),
                format!("{:.2}", figures.scale_factor_variation_ppm),
                format!("{:+.3}", figures.scale_factor_temperature_sensitivity_ppm_per_k),
                format!("{:.2}", figures.bias_variation_ug),
                format!("{:+.3}", figures.bias_temperature_sensitivity_ug_per_k),
            ]);
        }
    }
    (!rows.is_empty()).then_some(table)
}

fn allan_table(figures: &[RunFigures]) -> Option<Table> {
    let mut table = Table::new(["run", "averaging time s: deviation"]);
    let mut any = false;
    for run in figures {
        let Some(points) = &run.compensated.allan else { continue };
        any = true;
        let each = points.iter().map(|point| format!("{:.0}: {:.2}", point.tau_s, point.deviation_ug));
        table.row([run.run.clone(), each.collect::<Vec<_>>().join("   ")]);
    }
    any.then_some(table)
}
