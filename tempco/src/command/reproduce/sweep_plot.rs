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
        let shown = column.sweep.curves.iter().find(|curve| curve.temperature_c == SHOWN_C);
        let points = shown.into_iter().flat_map(|curve| &curve.points);
        chart.draw_series(LineSeries::new(points.map(|[a, residual]| (*a, a + residual)), colour.stroke_width(2)))?;
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
    let size = |value: &f64| match *value {
        value if value >= 0.999e6 => "1 g".to_owned(),
        value if value >= 999.0 => format!("{:.0} mg", value / 1e3),
        value if value >= 0.999 => format!("{value:.0} µg"),
        value => format!("{value} µg"),
    };
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

fn over_temperature(curves: &[Curve]) -> Vec<(f64, f64)> {
    let Some(first) = curves.first() else { return Vec::new() };
    let at = |(index, [acceleration_g, _]): (usize, &[f64; 2])| {
        let residuals: Vec<f64> = curves.iter().map(|curve| curve.points[index][1]).collect();
        (*acceleration_g, (rms(&residuals) * 1e6).clamp(LOW_UG, HIGH_UG))
    };
    first.points.iter().enumerate().map(at).collect()
}
