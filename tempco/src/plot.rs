//! Pictures: one look for all of them. What is drawn is said by whoever draws.

use crate::failure::Failure;
use crate::output::GENERATOR;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::fmt::Display;

/// Where something is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Colours that the colour-blind tell apart (Okabe and Ito 2008), dark enough for lines on white.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
pub const VERMILION: RGBColor = RGBColor(213, 94, 0);
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
pub const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub const SKY: RGBColor = RGBColor(86, 180, 233);
pub const PURPLE: RGBColor = RGBColor(204, 121, 167);
pub const GREY: RGBColor = RGBColor(120, 120, 120);
const INK: RGBColor = RGBColor(40, 40, 40);
const MESH: RGBColor = RGBColor(225, 225, 225);

const FAMILY: &str = "Helvetica, Arial, Liberation Sans, sans-serif";
/// Sizes of letters, in units that the backend makes 1/1.24 px.
const TITLE: f64 = 25.0;
const HEADING: f64 = 19.0;
const LABEL: f64 = 17.0;

/// Draws a picture with a title above and a legend below.
pub fn picture<E: Display>(
    size: (u32, u32),
    title: &str,
    legend: &[Entry],
    draw: impl FnOnce(&Area) -> Result<(), E>,
) -> Result<String, Failure> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(Failure::new)?;
        let (head, rest) = root.split_vertically(44);
        let (body, foot) = rest.split_vertically(rest.dim_in_pixel().1 as i32 - 36);
        let middle = style(TITLE, HPos::Center);
        head.draw(&Text::new(title.to_owned(), (size.0 as i32 / 2, 26), middle)).map_err(Failure::new)?;
        draw(&body).map_err(Failure::new)?;
        draw_legend(&foot, legend)?;
        root.present().map_err(Failure::new)?;
    }
    // By which tempco knows the picture again.
    let after = svg.find('>').map_or(0, |end| end + 1);
    svg.insert_str(after, &format!("<metadata>{GENERATOR}</metadata>"));
    Ok(svg)
}

/// One mark of a legend.
pub struct Entry {
    pub text: String,
    pub colour: RGBColor,
    pub mark: Mark,
}

/// What stands before a legend's text.
pub enum Mark {
    Line,
    Band,
}

impl Entry {
    pub fn line(text: impl Into<String>, colour: RGBColor) -> Self {
        Self { text: text.into(), colour, mark: Mark::Line }
    }

    pub fn band(text: impl Into<String>, colour: RGBColor) -> Self {
        Self { text: text.into(), colour, mark: Mark::Band }
    }
}

/// Letters are about this wide at [`LABEL`], px.
const LETTER: f64 = 6.9;
const MARK: i32 = 26;
const GAP: i32 = 22;

fn draw_legend(area: &Area, legend: &[Entry]) -> Result<(), Failure> {
    let width = |entry: &Entry| MARK + 6 + (entry.text.chars().count() as f64 * LETTER) as i32 + GAP;
    let total: i32 = legend.iter().map(width).sum();
    let mut x = (area.dim_in_pixel().0 as i32 - total + GAP) / 2;
    for entry in legend {
        let drawn = match entry.mark {
            Mark::Line => area.draw(&PathElement::new([(x, 16), (x + MARK, 16)], entry.colour.stroke_width(3))),
            Mark::Band => area.draw(&Rectangle::new([(x, 9), (x + MARK, 23)], entry.colour.mix(0.25).filled())),
        };
        drawn.map_err(Failure::new)?;
        let text = Text::new(entry.text.clone(), (x + MARK + 6, 16), style(LABEL, HPos::Left));
        area.draw(&text).map_err(Failure::new)?;
        x += width(entry);
    }
    Ok(())
}

fn style(size: f64, horizontal: HPos) -> TextStyle<'static> {
    (FAMILY, size).into_font().color(&INK).pos(Pos::new(horizontal, VPos::Center))
}

/// The heading of a panel.
pub fn heading() -> TextStyle<'static> {
    (FAMILY, HEADING).into_font().color(&INK)
}

/// Letters at axes.
pub fn label() -> TextStyle<'static> {
    (FAMILY, LABEL).into_font().color(&INK)
}

/// Lines of the grid.
pub fn mesh() -> ShapeStyle {
    MESH.stroke_width(1)
}

/// Lines of the axes.
pub fn axis() -> ShapeStyle {
    INK.stroke_width(1)
}
