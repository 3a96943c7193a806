//! A chart as data: two axes with units, layers of marks, and the words beside them. Whoever shows it draws it.

use serde::Serialize;

/// One chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// Its name in addresses and tests.
    pub id: String,
    /// What is drawn against what.
    pub title: String,
    /// What to look for, and what was left out of the drawing.
    pub caption: String,
    /// Horizontal.
    pub x: Axis,
    /// Vertical.
    pub y: Axis,
    /// From the bottom to the top.
    pub layers: Vec<Layer>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// The quantity.
    pub label: String,
    /// Its unit.
    pub unit: String,
    /// Equal steps or equal factors.
    pub scale: Scale,
    /// Its two ends.
    pub range: [f64; 2],
}

/// What equal distances on an axis stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal steps.
    Linear,
    /// Equal factors.
    Log,
}

/// Marks of one kind and one meaning.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "mark", rename_all = "kebab-case")]
pub enum Layer {
    /// One mark a sample or a state.
    Dots {
        /// In the legend.
        name: String,
        /// Colour and shape.
        tone: Tone,
        /// Places.
        x: Vec<f64>,
        /// Places.
        y: Vec<f64>,
        /// The run that each belongs to, by its place among [`super::Report::runs`]; empty where that means nothing.
        run: Vec<u16>,
    },
    /// A line through points in their order.
    Line {
        /// In the legend.
        name: String,
        /// Colour.
        tone: Tone,
        /// Places.
        x: Vec<f64>,
        /// Places.
        y: Vec<f64>,
        /// Whether it is no measurement.
        dashed: bool,
    },
    /// An uncertainty.
    Band {
        /// In the legend.
        name: String,
        /// Colour.
        tone: Tone,
        /// Places.
        x: Vec<f64>,
        /// Lower ends.
        low: Vec<f64>,
        /// Upper ends.
        high: Vec<f64>,
    },
    /// Coloured cells.
    Map {
        /// What the colour says.
        name: String,
        /// In this unit.
        unit: String,
        /// Borders of the columns.
        x_edges: Vec<f64>,
        /// Borders of the rows.
        y_edges: Vec<f64>,
        /// Row by row from the first edge; nothing where nothing was measured.
        values: Vec<Option<f64>>,
        /// The value of the strongest colour.
        limit: f64,
    },
    /// A rectangle: a domain.
    Outline {
        /// In the legend.
        name: String,
        /// Left and right.
        x: [f64; 2],
        /// Bottom and top.
        y: [f64; 2],
    },
    /// A line across the chart.
    Rule {
        /// Beside it.
        name: String,
        /// The axis that it marks a value of.
        axis: AxisName,
        /// The value.
        at: f64,
    },
}

/// One of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisName {
    /// Horizontal.
    X,
    /// Vertical.
    Y,
}

/// Colour and shape of a mark: a style sheet knows both, and neither says it alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tone {
    /// Background.
    Quiet,
    /// Blue circles.
    First,
    /// Vermilion crosses.
    Second,
    /// Green triangles.
    Third,
    /// Purple squares.
    Fourth,
    /// Orange diamonds.
    Fifth,
    /// Sky-blue plus signs.
    Sixth,
}

impl Tone {
    /// Every tone for a series, in the order in which they are told apart best.
    pub const SERIES: [Self; 6] = [Self::First, Self::Second, Self::Third, Self::Fourth, Self::Fifth, Self::Sixth];

    /// The tone of series number `index`.
    #[must_use]
    pub const fn series(index: usize) -> Self {
        Self::SERIES[index % Self::SERIES.len()]
    }
}

/// Room beyond the outermost values, as a part of the axis.
const MARGIN: f64 = 0.03;
/// Values are written to this part of an axis: a tenth of what a screen can show.
const RESOLUTION: f64 = 1e-4;

impl Axis {
    /// A linear axis around `values`, and around zero if nothing else.
    #[must_use]
    pub fn linear(label: &str, unit: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let [low, high] = ends(values, [-1.0, 1.0]);
        let room = if high > low { (high - low) * MARGIN } else { 1.0_f64.max(low.abs() * MARGIN) };
        Self { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Linear, range: [low - room, high + room] }
    }

    /// The same axis with other ends.
    #[must_use]
    pub fn with_range(self, range: [f64; 2]) -> Self {
        Self { range, ..self }
    }

    /// A logarithmic axis around the positive ones of `values`.
    #[must_use]
    pub fn log(label: &str, unit: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let [low, high] = ends(values.into_iter().filter(|value| *value > 0.0), [1.0, 10.0]);
        let room = (high / low).powf(MARGIN).max(1.05);
        Self { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Log, range: [low / room, high * room] }
    }

    /// Where a value lies between the ends, 0 to 1.
    #[must_use]
    pub fn part(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        match self.scale {
            Scale::Linear => (value - low) / (high - low),
            Scale::Log => (value / low).ln() / (high / low).ln(),
        }
    }

    /// The value with no more digits than a drawing can show.
    #[must_use]
    pub fn rounded(&self, value: f64) -> f64 {
        let step = match self.scale {
            Scale::Linear => (self.range[1] - self.range[0]) * RESOLUTION,
            Scale::Log => value.abs() * RESOLUTION,
        };
        let digits = -step.log10().floor();
        // Divided by a power of ten, not multiplied by its inverse, a decimal stays the shortest one.
        let factor = 10.0_f64.powf(digits.abs());
        let rounded = if digits >= 0.0 { (value * factor).round() / factor } else { (value / factor).round() * factor };
        if rounded.is_finite() { rounded + 0.0 } else { value }
    }

    /// See [`Axis::rounded`].
    #[must_use]
    pub fn all_rounded(&self, values: impl IntoIterator<Item = f64>) -> Vec<f64> {
        values.into_iter().map(|value| self.rounded(value)).collect()
    }
}

fn ends(values: impl IntoIterator<Item = f64>, of_none: [f64; 2]) -> [f64; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = values.into_iter().fold(start, |[low, high], value| [low.min(value), high.max(value)]);
    if low <= high { [low, high] } else { of_none }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_written_with_the_digits_that_a_drawing_can_show() {
        let axis = Axis::linear("temperature", "°C", [-40.0, 60.0]);
        assert_eq!(axis.rounded(20.312_345_6), 20.31);
        let wide = Axis::linear("time", "s", [0.0, 1e7]);
        assert_eq!(wide.rounded(1_234_567.8), 1_235_000.0);
        let log = Axis::log("averaging time", "s", [1.0, 4096.0]);
        assert_eq!(log.rounded(4095.96), 4096.0);
    }

    #[test]
    fn a_constant_has_an_axis_too() {
        let axis = Axis::linear("level", "g", [0.0, 0.0]);
        assert!(axis.range[0] < 0.0 && axis.range[1] > 0.0 && axis.part(0.0) == 0.5);
        assert_eq!(Axis::log("time", "min", []).range.map(f64::round), [1.0, 11.0]);
    }
}
