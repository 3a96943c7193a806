//! The Allan plot with the noise that it shows.

use super::chart::{Axis, Chart, Layer, Tone};
use crate::compare::{Comparison, RunFigures};
use crate::metrics::allan::AllanPoint;
use crate::metrics::allan_model::{AllanModel, Coefficient};

/// Recordings in one plot.
const MOST_RUNS: usize = 3;
/// Points of the fitted curve.
const CURVE: i32 = 60;

/// Held-out recordings at rest, or all where none was held out; `None` without any.
#[must_use]
pub fn allan_chart(comparison: &Comparison) -> Option<Chart> {
    let mut runs: Vec<(&RunFigures, &Vec<AllanPoint>)> = comparison
        .figures
        .iter()
        .filter(|run| run.held_out || !comparison.held_out)
        .filter_map(|run| Some((run, run.compensated.allan.as_ref()?)))
        .collect();
    runs.sort_by_key(|(_, points)| std::cmp::Reverse(points.len()));
    runs.truncate(MOST_RUNS);
    let (longest, _) = runs.first()?;
    let pooled: Vec<AllanPoint> = runs.iter().flat_map(|(_, points)| points.iter().copied()).collect();
    let raw = longest.raw.allan.as_deref().unwrap_or_default();
    let x = Axis::log("averaging time", "s", pooled.iter().map(|point| point.tau_s));
    let reach = |point: &AllanPoint| [low(point), high(point)];
    let y = Axis::log("Allan deviation", "µg", pooled.iter().chain(raw).flat_map(reach));
    let mut layers = vec![line(&format!("raw, {}", longest.run), Tone::Quiet, raw, &x, &y)];
    for (index, (run, points)) in runs.iter().enumerate() {
        let tone = Tone::series(index);
        layers.push(band(points, tone, &x, &y));
        layers.push(line(&format!("compensated, {}", run.run), tone, points, &x, &y));
    }
    let model = AllanModel::fit(&pooled);
    layers.extend(model.map(|model| curve(&model, &x, &y)));
    let fitted = model.map_or_else(|| "Too few points for a fit.".to_owned(), |model| words(&model));
    Some(Chart {
        id: "allan".to_owned(),
        title: "Allan deviation at rest".to_owned(),
        caption: format!("{fitted} The band is ±1 standard uncertainty of each point."),
        x,
        y,
        layers,
    })
}

fn low(point: &AllanPoint) -> f64 {
    point.deviation_ug * (1.0 - point.relative_uncertainty).max(0.1)
}

fn high(point: &AllanPoint) -> f64 {
    point.deviation_ug * (1.0 + point.relative_uncertainty)
}

fn line(name: &str, tone: Tone, points: &[AllanPoint], x: &Axis, y: &Axis) -> Layer {
    Layer::Line {
        name: name.to_owned(),
        tone,
        x: x.all_rounded(points.iter().map(|point| point.tau_s)),
        y: y.all_rounded(points.iter().map(|point| point.deviation_ug)),
        dashed: false,
    }
}

fn band(points: &[AllanPoint], tone: Tone, x: &Axis, y: &Axis) -> Layer {
    Layer::Band {
        name: String::new(),
        tone,
        x: x.all_rounded(points.iter().map(|point| point.tau_s)),
        low: y.all_rounded(points.iter().map(low)),
        high: y.all_rounded(points.iter().map(high)),
    }
}

fn curve(model: &AllanModel, x: &Axis, y: &Axis) -> Layer {
    let [from, to] = x.range;
    let taus: Vec<f64> = (0..=CURVE).map(|k| from * (to / from).powf(f64::from(k) / f64::from(CURVE))).collect();
    Layer::Line {
        name: "fitted noise".to_owned(),
        tone: Tone::Fourth,
        x: x.all_rounded(taus.iter().copied()),
        y: y.all_rounded(taus.iter().map(|tau_s| model.deviation_ug(*tau_s))),
        dashed: true,
    }
}

fn words(model: &AllanModel) -> String {
    let stated = |name: &str, coefficient: Coefficient, unit: &str| match coefficient {
        Coefficient { value: 0.0, .. } => format!("no {name} to be seen"),
        Coefficient { value, sigma } => {
            // Two digits of the uncertainty, and as many of the value.
            let digits = (1.0 - sigma.max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{name} {value:.digits$} ± {sigma:.digits$} {unit}")
        }
    };
    let walk = |Coefficient { value, sigma }: Coefficient| Coefficient { value: value * 60.0, sigma: sigma * 60.0 };
    format!(
        "Fitted: {}; {}; {}.",
        stated("white noise N", model.white_ug_sqrt_s, "µg·√s"),
        stated("bias instability B", model.flicker_ug, "µg"),
        stated("random walk K", walk(model.walk_ug_per_sqrt_s), "µg/√h")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_stated_with_the_digits_that_they_have() {
        let model = AllanModel {
            white_ug_sqrt_s: Coefficient { value: 4.883_7, sigma: 0.004_2 },
            flicker_ug: Coefficient { value: 1.4, sigma: 1.7 },
            walk_ug_per_sqrt_s: Coefficient { value: 0.0, sigma: 0.0 },
        };
        let text = "Fitted: white noise N 4.8837 ± 0.0042 µg·√s; bias instability B 1.4 ± 1.7 µg; no random walk K to be seen.";
        assert_eq!(words(&model), text);
    }
}
