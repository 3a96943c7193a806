//! Tables 1 and 2 as text: the paper's numbers beside ours, and what such tables do not show.

use super::campaigns::Judged;
use super::extent::Extent;
use super::number::number;
use super::shortfalls;
use crate::table::Table;
use std::fmt::Write;
use trainer::metrics::{full_temperature, zero_bias};
use trainer::reproduction::column::{COLUMNS, DEFAULT, FA_BP, IFA_BP};
use trainer::reproduction::evolution::Quartiles;
use trainer::reproduction::judgement::Judgement;
use trainer::reproduction::paper::{Contradiction, Figure, PaperRow, ROWS, contradiction};
use trainer::reproduction::sweep;
use trainer::reproduction::trial::Share;

/// All campaigns.
pub fn text(judged: &[Judged], extent: &Extent) -> String {
    let Extent { restarts, passes, seed, .. } = extent;
    let mut text = format!(
        "Tables 1 and 2: one model for all test data sets, trained on zero-train-* and full-train-* only; {restarts} \
         trainings each, the one of least cost kept; {passes} passes of gradient descent; seed {seed}.\n\
         The paper compensates both zero-bias data sets by \"the same model\" and both full-temperature data sets by \
         \"the same model\"; whether the two are one, it does not say. Here they are.\n\n"
    );
    for column in COLUMNS {
        let _ = writeln!(text, "  {:10} {}", column.name, column.about);
    }
    let _ = writeln!(text, "  {:10} least squares in Δf² · T³", "polynomial");
    let _ = writeln!(text, "  {:10} the twin's own inverse: what a static compensation could reach", "perfect map");
    for (index, one) in judged.iter().enumerate() {
        // The others are readings of Table 2, data set 1.
        text += &campaign(one, if index == 0 { |_| true } else { |row| row.table == 2 });
    }
    text += &same_device(judged);
    let _ = writeln!(text, "\n{}\n{}\n{}", zero_bias::DEFINITION, full_temperature::DEFINITION, sweep::DEFINITION);
    text
}

fn campaign(judged: &Judged, shown: fn(&PaperRow) -> bool) -> String {
    let Judged { scenario, columns, shortfalls, trained_on } = judged;
    let mut text = format!("\nCampaign `{}`: {}\n", scenario.name, scenario.description);
    if let Some(other) = trained_on {
        let _ = writeln!(text, "Its training runs are those of `{other}`, and so are the models.");
    }
    text += &figures(columns, shown).to_string();
    text += &shortfalls::text(shortfalls, shown);
    if trained_on.is_none() {
        text += "\nWhat the tables do not show\n";
        text += &beyond(columns).to_string();
        text += &words(columns);
    }
    text
}

/// The paper's numbers and ours.
fn figures(columns: &[Judgement], shown: fn(&PaperRow) -> bool) -> Table {
    let mut header: Vec<String> = ["data set", "paper: raw", "FA-BP", "IFA-BP", "here:"].map(str::to_owned).to_vec();
    header.extend(columns.iter().map(|column| column.name.clone()));
    let mut rows = vec![header];
    for (index, paper) in ROWS.iter().enumerate().filter(|(_, row)| shown(row)) {
        let mut row = vec![format!("{}: {}", paper.data_set, paper.figure.name())];
        row.extend([paper.raw, paper.fa_bp, paper.ifa_bp].map(number));
        row.push(String::new());
        row.extend(columns.iter().map(|column| match column.cells[index] {
            Some(value) if column.name == DEFAULT && value > paper.ifa_bp => format!("*{}", number(value)),
            Some(value) => number(value),
            None => "–".to_owned(),
        }));
        rows.push(row);
    }
    Table::of(rows)
}

/// Residuals with their constants, and between the levels.
fn beyond(columns: &[Judgement]) -> Table {
    let mut table = Table::new([
        "method",
        "cells ≤ paper's IFA-BP",
        "test residual µg",
        "at ±0.5 g µg",
        "worst slope error ppm",
        "restarts µg: median (quartiles)",
    ]);
    for column in columns {
        let Share { hits, of } = column.as_good_as_the_paper();
        let restarts = column.restart_quartiles_ug().map_or_else(
            || "–".to_owned(),
            |Quartiles { lower, median, upper }| format!("{} ({} … {})", number(median), number(lower), number(upper)),
        );
        table.row([
            column.name.clone(),
            format!("{hits} of {of}"),
            number(column.residual_ug),
            number(column.sweep.at_half_g_ug()),
            number(column.sweep.worst_slope_ppm()),
            restarts,
        ]);
    }
    table
}

/// A slope further off than this measures no acceleration, ppm.
const USELESS_PPM: f64 = 1e5;

/// What a method is by its slope, and by its table.
fn verdict(slope_ppm: f64, is_as_good_as_the_paper: bool) -> &'static str {
    match is_as_good_as_the_paper {
        _ if slope_ppm < USELESS_PPM => "an accelerometer",
        true => "a beautiful table, a useless sensor",
        false => "no accelerometer",
    }
}

/// Which of the trained methods are accelerometers, and which of the paper's two trains better.
fn words(columns: &[Judgement]) -> String {
    let mut text = String::new();
    for column in columns.iter().filter(|column| !column.restarts_ug.is_empty()) {
        let Share { hits, of } = column.as_good_as_the_paper();
        let (slope_ppm, half_g_ug) = (column.sweep.worst_slope_ppm(), column.sweep.at_half_g_ug());
        let verdict = verdict(slope_ppm, hits == of);
        let (name, half_g) = (&column.name, number(half_g_ug * 1e-3));
        let slope = if slope_ppm < 1e3 {
            format!("{} ppm", number(slope_ppm))
        } else {
            format!("{} %", number(slope_ppm * 1e-4))
        };
        let _ = writeln!(
            text,
            "  {name}: {hits} of {of} cells as good as the paper's; slope off by up to {slope}, {half_g} mg wrong at ±0.5 g: {verdict}."
        );
    }
    let of = |name: &str| columns.iter().find(|column| column.name == name);
    if let (Some(standard), Some(improved)) = (of(FA_BP), of(IFA_BP)) {
        let share = improved.trains_better_than(standard);
        let _ = writeln!(
            text,
            "  IFA-BP ends with the lower training residual in {:.0} % of all pairs of an IFA-BP and an FA-BP restart.",
            share.percent()
        );
    }
    text
}

/// The paper's two raw variations of the scale factor, and what one device can do.
fn same_device(judged: &[Judged]) -> String {
    let rows: Vec<usize> =
        (0..ROWS.len()).filter(|&index| ROWS[index].figure == Figure::ScaleFactorVariation).collect();
    let mut text = format!(
        "\nOne device, one static map, one variation of the scale factor: yet the paper prints {} for its raw \
         full-temperature data sets. The simulated raw figures:\n",
        rows.iter().map(|&index| format!("{} ppm", number(ROWS[index].raw))).collect::<Vec<_>>().join(" and ")
    );
    for one in judged {
        let raw = one.columns.first();
        let values: Vec<String> = rows
            .iter()
            .map(|&index| raw.and_then(|raw| raw.cells[index]).map_or_else(|| "–".to_owned(), number))
            .collect();
        let _ = writeln!(text, "  {:8} {} ppm   {}", one.scenario.name, values.join(" and "), one.scenario.description);
    }
    text + &blindness()
}

/// What Table 2 itself says of a model that compensates both data sets.
fn blindness() -> String {
    let Contradiction { raw_ppm, compensated_ppm } = contradiction();
    format!(
        "If the paper's two are one device and one model, as it says, then at some node the raw outputs between −1 and \
         +1 g differ by\nat least {:.1} mg per g from data set to data set, and the compensated ones by at most {:.1} mg per \
         g: there the model is blind to\nthe difference, as a classifier of levels is and an accelerometer is not.\n",
        raw_ppm * 1e-3,
        compensated_ppm * 1e-3
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::reproduction::sweep::{Curve, Sweep};

    /// A method that is as good as the paper in all cells but so many, and reads the acceleration with this slope.
    fn method(name: &str, bad_cells: usize, slope: f64) -> Judgement {
        let mut cells = ROWS.map(|row| Some(row.ifa_bp));
        cells.iter_mut().take(bad_cells).for_each(|cell| *cell = Some(1e9));
        let points = (-40..=40).map(|step| f64::from(step) / 40.0).map(|a| [a, (slope - 1.0) * a]).collect();
        let sweep = Sweep { curves: vec![Curve { temperature_c: 20.0, points }] };
        Judgement { name: name.to_owned(), cells, residual_ug: 5.0, sweep, restarts_ug: vec![1.0, 3.0] }
    }

    #[test]
    fn a_method_is_called_by_its_slope_before_its_table() {
        let raw = Judgement { restarts_ug: Vec::new(), ..method("raw", 0, 1.0) };
        let columns = [raw, method("good", 2, 1.0002), method("classifier", 0, 0.0), method("neither", 1, 2.0)];
        let of = ROWS.len();
        assert_eq!(
            words(&columns),
            format!(
                "  good: {} of {of} cells as good as the paper's; slope off by up to 200.0 ppm, 0.10 mg wrong at ±0.5 g: \
                 an accelerometer.\n  classifier: {of} of {of} cells as good as the paper's; slope off by up to 100.0 %, \
                 500.0 mg wrong at ±0.5 g: a beautiful table, a useless sensor.\n  neither: {} of {of} cells as good as \
                 the paper's; slope off by up to 100.0 %, 500.0 mg wrong at ±0.5 g: no accelerometer.\n",
                of - 2,
                of - 1
            )
        );
        assert_eq!((verdict(99_999.0, true), verdict(1e5, false)), ("an accelerometer", "no accelerometer"));
    }

    #[test]
    fn of_the_papers_two_it_is_told_how_often_one_trains_better() {
        let improved = Judgement { restarts_ug: vec![1.0, 2.0, 3.0, 9.0], ..method(IFA_BP, 0, 1.0) };
        let standard = Judgement { restarts_ug: vec![4.0], ..method(FA_BP, 0, 1.0) };
        assert!(
            words(&[standard, improved]).contains("IFA-BP ends with the lower training residual in 75 % of all pairs")
        );
    }

    #[test]
    fn a_cell_above_the_paper_is_marked_for_the_default_method_only() {
        let table = figures(&[method(DEFAULT, 1, 1.0), method(FA_BP, 1, 1.0)], |_| true).to_string();
        assert_eq!(table.matches("*1000000000").count(), 1, "{table}");
        assert_eq!(table.lines().count(), 1 + ROWS.len(), "{table}");
    }

    #[test]
    fn the_papers_two_raw_variations_of_one_device_stand_side_by_side() {
        let text = same_device(&[]);
        let printed: Vec<String> = ROWS
            .iter()
            .filter(|row| row.figure == Figure::ScaleFactorVariation)
            .map(|row| format!("{} ppm", number(row.raw)))
            .collect();
        assert!(text.contains(&format!("the paper prints {} for", printed.join(" and "))), "{text}");
        assert!(text.contains("there the model is blind"), "{text}");
    }
}
