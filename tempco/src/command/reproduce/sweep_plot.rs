//! What the tables do not show, as a picture: what each method reads between −1, 0 and +1 g.

use super::campaigns::Judged;
use crate::failure::Failure;
use crate::plot::{
    Area, BLUE, Entry, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, axis, heading, label, mesh, picture,
};
use plotters::prelude::*;
use trainer::noise::rms;
use trainer::reproduction::judgement::Judgement;
use trainer::reproduction::sweep::Curve;

type DrawError = DrawingAreaErrorKind<std::io::Error>;

const SIZE: (u32, u32) = (1400, 660);
const COLOURS: [RGBColor; 7] = [GREY, ORANGE, VERMILION, PURPLE, BLUE, GREEN, SKY];
/// The range of residuals that is drawn, µg.
const LOW_UG: f64 = 0.1;
const HIGH_UG: f64 = 1e6;
/// A smaller slope error is the rounding of the samples: the perfect map, which has no place on a logarithmic axis.
const PERFECT_PPM: f64 = 1.0;
/// The temperature of the readings on the left, °C.
const SHOWN_C: f64 = 20.0;

/// Readings at one temperature on the left, residuals over all temperatures on the right, one line a method.
pub fn sweep(judged: &[Judged]) -> Result<String, Failure> {
    let Some(first) = judged.first() else { return Err(Failure::new("no campaign was judged")) };
    let drawn: Vec<(&Judgement, RGBColor)> = first
        .columns
        .iter()
        .filter(|column| column.sweep.worst_slope_ppm() > PERFECT_PPM)
        .zip(COLOURS.into_iter().cycle())
        .collect();
    let title = format!(
        "Campaign {}: what each method reads between the levels it was trained on, −1, 0 and +1 g",
        first.scenario.name
    );
    let legend: Vec<Entry> = drawn.iter().map(|(column, colour)| Entry::line(column.name.clone(), *colour)).collect();
    picture(SIZE, &title, &legend, |area| {
        let (left, right) = area.split_horizontally(600);
        readings(&left, &drawn)?;
        residuals(&right, &drawn)
    })
}

fn readings(area: &Area, columns: &[(&Judgement, RGBColor)]) -> Result<(), DrawError> {
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .caption(format!("Reading at {SHOWN_C} °C"), heading())
        .x_label_area_size(48)
        .y_label_area_size(66)
        .build_cartesian_2d(-1.02..1.02, -1.3..1.3)?;
    let mut grid = chart.configure_mesh();
    grid.x_labels(11).y_labels(13).light_line_style(WHITE).bold_line_style(mesh());
    grid.axis_style(axis()).label_style(label()).axis_desc_style(label());
    grid.x_label_formatter(&g).y_label_formatter(&g);
    grid.x_desc("applied acceleration, g").y_desc("reading, g").draw()?;
    for (column, colour) in columns {
        chart.draw_series(LineSeries::new(at_shown_temperature(&column.sweep.curves), colour.stroke_width(2)))?;
    }
    for level in [-1.0, 0.0, 1.0] {
        chart.draw_series([Circle::new((level, level), 6, axis())])?;
    }
    Ok(())
}

fn residuals(area: &Area, columns: &[(&Judgement, RGBColor)]) -> Result<(), DrawError> {
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .caption("How wrong it is, RMS over −40 … 60 °C", heading())
        .x_label_area_size(48)
        .y_label_area_size(78)
        .build_cartesian_2d(-1.02..1.02, (LOW_UG..HIGH_UG).log_scale())?;
    let mut grid = chart.configure_mesh();
    grid.x_labels(11).y_labels(9).light_line_style(WHITE).bold_line_style(mesh());
    grid.axis_style(axis()).label_style(label()).axis_desc_style(label());
    grid.x_label_formatter(&g).y_label_formatter(&size);
    grid.x_desc("applied acceleration, g").y_desc("residual").draw()?;
    for (column, colour) in columns {
        chart.draw_series(LineSeries::new(over_temperature(&column.sweep.curves), colour.stroke_width(2)))?;
    }
    Ok(())
}

fn g(value: &f64) -> String {
    if value.abs() < 1e-9 { "0".to_owned() } else { format!("{value:+.1}").replace('-', "−") }
}

/// A power of ten of µg in its usual unit.
fn size(value_ug: &f64) -> String {
    match *value_ug {
        value if value >= 0.999e6 => "1 g".to_owned(),
        value if value >= 999.0 => format!("{:.0} mg", value / 1e3),
        value if value >= 0.999 => format!("{value:.0} µg"),
        value => format!("{value} µg"),
    }
}

/// Acceleration and reading, g.
fn at_shown_temperature(curves: &[Curve]) -> Vec<(f64, f64)> {
    let shown = curves.iter().filter(|curve| curve.temperature_c == SHOWN_C);
    shown.flat_map(|curve| &curve.points).map(|[a, residual]| (*a, a + residual)).collect()
}

/// Acceleration, g, and residual over all temperatures, µg.
fn over_temperature(curves: &[Curve]) -> Vec<(f64, f64)> {
    let Some(first) = curves.first() else { return Vec::new() };
    let at = |(index, [acceleration_g, _]): (usize, &[f64; 2])| {
        let residuals: Vec<f64> = curves.iter().map(|curve| curve.points[index][1]).collect();
        (*acceleration_g, (rms(&residuals) * 1e6).clamp(LOW_UG, HIGH_UG))
    };
    first.points.iter().enumerate().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curves() -> Vec<Curve> {
        let curve = |temperature_c: f64, residual_g: f64| Curve {
            temperature_c,
            points: vec![[-0.5, residual_g], [0.5, 0.0], [1.0, 1e3 * residual_g]],
        };
        vec![curve(-40.0, 3e-3), curve(SHOWN_C, 4e-3)]
    }

    #[test]
    fn the_reading_is_that_of_one_temperature_and_the_residual_that_of_all() {
        assert_eq!(at_shown_temperature(&curves()), [(-0.5, -0.496), (0.5, 0.5), (1.0, 5.0)]);
        let over = over_temperature(&curves());
        let root_ug = (12.5_f64 * 1e-6).sqrt() * 1e6;
        assert!(over[0].0 == -0.5 && (over[0].1 / root_ug - 1.0).abs() < 1e-12, "{over:?}");
        // What a logarithmic axis has no place for stands at its ends.
        assert_eq!(over[1..], [(0.5, LOW_UG), (1.0, HIGH_UG)]);
        assert_eq!(over_temperature(&[]), []);
    }

    #[test]
    fn every_method_but_the_perfect_one_has_its_line_in_both_panels() {
        let column = |name: &str, slope: f64| {
            let points = (-40..=40).map(|step| f64::from(step) / 40.0).map(|a| [a, (slope - 1.0) * a]).collect();
            let curves = vec![Curve { temperature_c: SHOWN_C, points }];
            let sweep = trainer::reproduction::sweep::Sweep { curves };
            let cells = [None; trainer::reproduction::paper::ROWS.len()];
            Judgement { name: name.to_owned(), cells, residual_ug: 1.0, sweep, restarts_ug: Vec::new() }
        };
        let scenario = firmware_sim::scenario::Scenario::preset("seed").expect("a scenario");
        // What is off by the limit is perfect still.
        let mut limit = column("limit", 1.0);
        limit.sweep.curves[0].points = vec![[0.0, 0.0], [1.0, PERFECT_PPM * 1e-6]];
        assert_eq!(limit.sweep.worst_slope_ppm(), PERFECT_PPM);
        let columns = vec![column("raw", 1.1), column("perfect map", 1.0), limit, column("trained", 1.01)];
        let svg = sweep(&[Judged { scenario, columns, shortfalls: Vec::new(), trained_on: None }]).expect("a picture");
        let texts: Vec<&str> = svg.lines().map(str::trim).collect();
        let shown = |text: &str| texts.iter().filter(|one| **one == text).count();
        assert_eq!((shown("raw"), shown("perfect map"), shown("limit"), shown("trained")), (1, 0, 0, 1));
        assert_eq!((shown("applied acceleration, g"), shown("reading, g"), shown("residual")), (2, 1, 1));
        assert_eq!((shown("1 mg"), shown("Reading at 20 °C")), (1, 1));
        // A line in each panel and a mark in the legend.
        for colour in COLOURS.iter().take(2) {
            let RGBColor(red, green, blue) = colour;
            let hex = format!("stroke=\"#{red:02X}{green:02X}{blue:02X}\"");
            assert_eq!(svg.matches(&hex).count(), 3, "{hex}");
        }
        assert!(sweep(&[]).is_err());
    }

    #[test]
    fn the_axes_are_labelled_in_usual_units() {
        for (value_ug, text) in
            [(0.1, "0.1 µg"), (1.0, "1 µg"), (100.0, "100 µg"), (1e3, "1 mg"), (1e5, "100 mg"), (1e6, "1 g")]
        {
            assert_eq!(size(&value_ug), text);
        }
        for (value_g, text) in [(0.0, "0"), (1e-12, "0"), (1e-9, "+0.0"), (0.2, "+0.2"), (-1.0, "−1.0")] {
            assert_eq!(g(&value_g), text);
        }
    }
}
