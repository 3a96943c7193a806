//! Scale factor, bias and output over temperature, raw and compensated (Huang et al. 2022, Figures 8 to 10).

use super::chart::{Axis, Chart, Layer, Tone};
use crate::compare::{Comparison, RunFigures, mean_slope_g_per_hz};
use crate::metrics::full_temperature::{FullTemperature, Node};
use crate::metrics::levels::level_width;
use crate::metrics::mean;
use crate::metrics::states::{State, states};
use crate::model::Model;
use crate::residuals::{Residuals, RunResiduals};

/// Runs in one chart.
const MOST_RUNS: usize = 6;
/// States closer than this belong to one node, °C.
const SAME_NODE_C: f64 = 3.0;

/// A line through points.
struct Series {
    name: String,
    tone: Tone,
    points: Vec<[f64; 2]>,
}

/// Two charts for each of scale factor and bias: raw beside compensated, and compensated alone.
#[must_use]
pub fn node_charts(comparison: &Comparison) -> Vec<Chart> {
    let counted = comparison.figures.iter().filter(|run| run.held_out || !comparison.held_out);
    let runs: Vec<(&RunFigures, &FullTemperature, &FullTemperature)> = counted
        .filter_map(|run| Some((run, run.raw.full_temperature.as_ref()?, run.compensated.full_temperature.as_ref()?)))
        .take(MOST_RUNS)
        .collect();
    if runs.is_empty() {
        return Vec::new();
    }
    let scale_factor = |of: &FullTemperature| relative_ppm(&of.nodes);
    let bias_mg = |of: &FullTemperature| deviation(&of.nodes, 1e3);
    let bias_ug = |of: &FullTemperature| deviation(&of.nodes, 1e6);
    let compensated = |value: &dyn Fn(&FullTemperature) -> Vec<[f64; 2]>| -> Vec<Series> {
        let each = runs.iter().enumerate();
        each.map(|(k, (run, _, after))| series(&run.run, Tone::series(k), value(after))).collect()
    };
    // All raw runs look alike, and so do all compensated ones: the first of each stands in the legend.
    let named = |name: &'static str, k: usize| if k == 0 { name } else { "" };
    let both = |value: &dyn Fn(&FullTemperature) -> Vec<[f64; 2]>| -> Vec<Series> {
        let each = || runs.iter().enumerate();
        let before = each().map(|(k, (_, raw, _))| series(named("raw", k), Tone::Second, value(raw)));
        let after = each().map(|(k, (_, _, after))| series(named("compensated", k), Tone::First, value(after)));
        before.chain(after).collect()
    };
    let of = list(runs.iter().map(|(run, ..)| run.run.as_str()));
    let ppm = |series: Vec<Series>, id: &str, title: &str| {
        chart(
            id,
            title,
            &format!("{of}: K1 of each node less its mean over the nodes."),
            ("K1 less its mean", "ppm"),
            &series,
        )
    };
    let bias = |series: Vec<Series>, id: &str, title: &str, unit: &str| {
        chart(
            id,
            title,
            &format!("{of}: B0 of each node less its mean over the nodes."),
            ("bias less its mean", unit),
            &series,
        )
    };
    vec![
        ppm(both(&scale_factor), "scale-factor", "Scale factor K1 over temperature, raw and compensated"),
        ppm(compensated(&scale_factor), "scale-factor-compensated", "Scale factor K1 over temperature, compensated"),
        bias(both(&bias_mg), "bias", "Bias over temperature, raw and compensated", "mg"),
        bias(compensated(&bias_ug), "bias-compensated", "Bias over temperature, compensated", "µg"),
    ]
}

fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    format!("Run{} {}", if names.len() > 1 { "s" } else { "" }, names.join(", "))
}

fn relative_ppm(nodes: &[Node]) -> Vec<[f64; 2]> {
    let middle = mean(&nodes.iter().map(|node| node.scale_factor_per_g).collect::<Vec<_>>());
    nodes.iter().map(|node| [node.temperature_c, (node.scale_factor_per_g / middle - 1.0) * 1e6]).collect()
}

fn deviation(nodes: &[Node], per_g: f64) -> Vec<[f64; 2]> {
    let middle = mean(&nodes.iter().map(|node| node.bias_g).collect::<Vec<_>>());
    nodes.iter().map(|node| [node.temperature_c, (node.bias_g - middle) * per_g]).collect()
}

/// The output at the lowest, the middle and the highest level over temperature, raw and compensated, of the run with the most nodes that counts.
#[must_use]
pub fn level_charts(model: &Model, comparison: &Comparison, residuals: &Residuals) -> Vec<Chart> {
    let nodes = |run: &RunFigures| run.raw.full_temperature.as_ref().map(|figures| figures.nodes.len());
    let wanted = |run: &&RunFigures| (run.held_out || !comparison.held_out) && nodes(run).is_some();
    let Some(chosen) = comparison.figures.iter().filter(wanted).max_by_key(|run| nodes(run)) else { return Vec::new() };
    let Some(run) = residuals.runs.iter().find(|run| run.run.name == chosen.run) else { return Vec::new() };
    let slope = mean_slope_g_per_hz(model);
    let raw_mg = |state: &State| state_mean(state, run, |k| run.run.rows[k].sample.delta_f_uhz as f64 * slope * 1e-3);
    let left_ug = |state: &State| state_mean(state, run, |k| run.residuals_g[k] * 1e6);
    let raw = levels(run, raw_mg).map(|series| Series { points: about_mean(&series.points), ..series });
    let name = &chosen.run;
    vec![
        chart(
            "levels-raw",
            "Raw output over temperature at each level",
            &format!("Run {name}: Δf over the mean scale factor, less its mean at the level."),
            ("output less its mean", "mg"),
            &raw.collect::<Vec<_>>(),
        ),
        chart(
            "levels-compensated",
            "Compensated output over temperature at each level",
            &format!("Run {name}: reading less reference, nothing else taken off."),
            ("reading less reference", "µg"),
            &levels(run, left_ug).collect::<Vec<_>>(),
        ),
    ]
}

fn levels<'a>(run: &'a RunResiduals, value: impl Fn(&State) -> f64 + 'a) -> impl Iterator<Item = Series> + 'a {
    let all = states(run.run);
    let width_g = level_width(&run.run.rows.iter().map(|row| row.reference_g).collect::<Vec<_>>());
    shown_levels_g(&all, width_g).into_iter().enumerate().map(move |(k, level_g)| {
        let near = |state: &&State| (state.reference_g - level_g).abs() <= width_g;
        let points = all.iter().filter(near).map(|state| [state.temperature_c, value(state)]).collect();
        series(&level_name(level_g, width_g), Tone::series(k), points)
    })
}

/// Lowest, middle and highest of the levels, as many as there are: −1, 0 and +1 g of the paper.
fn shown_levels_g(states: &[State], width_g: f64) -> Vec<f64> {
    let levels = || states.iter().map(|state| state.reference_g);
    let (low, high) = (levels().fold(f64::MAX, f64::min), levels().fold(f64::MIN, f64::max));
    let from_middle = |level: &f64| (level - f64::midpoint(low, high)).abs();
    let middle = levels().min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
    let mut shown: Vec<f64> = std::iter::once(low).chain(middle).chain([high]).collect();
    shown.dedup_by(|b, a| *b - *a <= width_g);
    shown
}

fn level_name(level_g: f64, width_g: f64) -> String {
    if level_g.abs() <= width_g {
        return "0 g".to_owned();
    }
    let text = format!("{level_g:+.3}");
    format!("{} g", text.trim_end_matches('0').trim_end_matches('.').replace('-', "−"))
}

fn state_mean(state: &State, run: &RunResiduals, value: impl Fn(usize) -> f64) -> f64 {
    let last = run.run.rows.len();
    mean(&state.rows.clone().filter(|k| *k < last).map(value).collect::<Vec<_>>())
}

/// Less the mean over the nodes, whatever number of states each has.
fn about_mean(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let middle = mean(&node_means(points).iter().map(|node| node[1]).collect::<Vec<_>>());
    points.iter().map(|[x, y]| [*x, y - middle]).collect()
}

fn series(name: &str, tone: Tone, mut points: Vec<[f64; 2]>) -> Series {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Series { name: name.to_owned(), tone, points }
}

fn chart(id: &str, title: &str, caption: &str, (label, unit): (&str, &str), all: &[Series]) -> Chart {
    let values = |axis: usize| all.iter().flat_map(move |series| series.points.iter().map(move |point| point[axis]));
    let (x, y) = (Axis::linear("temperature", "°C", values(0)), Axis::linear(label, unit, values(1)));
    let mut layers = Vec::new();
    for Series { name, tone, points } in all {
        let rounded = |axis: &Axis, of: usize, points: &[[f64; 2]]| axis.all_rounded(points.iter().map(|p| p[of]));
        let nodes = node_means(points);
        let (line_x, line_y) = (rounded(&x, 0, &nodes), rounded(&y, 1, &nodes));
        layers.push(Layer::Line { name: String::new(), tone: *tone, x: line_x, y: line_y, dashed: false });
        // Marks on the line, so that a line is told from another without colours.
        let (xs, ys) = (rounded(&x, 0, points), rounded(&y, 1, points));
        layers.push(Layer::Dots { name: name.clone(), tone: *tone, x: xs, y: ys, run: Vec::new() });
    }
    Chart { id: id.to_owned(), title: title.to_owned(), caption: caption.to_owned(), x, y, layers }
}

/// A node may have two states at one level, +0 g and −0 g: the line goes through their mean.
fn node_means(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let centre = |node: &[[f64; 2]]| [0, 1].map(|axis| mean(&node.iter().map(|p| p[axis]).collect::<Vec<_>>()));
    points.chunk_by(|a, b| b[0] - a[0] < SAME_NODE_C).map(centre).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_levels_of_a_chart_are_those_of_the_run() {
        let states = |levels: &[f64]| -> Vec<State> {
            levels.iter().map(|&reference_g| State { rows: 0..1, reference_g, temperature_c: 0.0 }).collect()
        };
        let tumble: Vec<f64> = (0..24).map(|k| (f64::from(k) * 15.0).to_radians().cos()).collect();
        let names = |levels: &[f64]| -> Vec<String> {
            shown_levels_g(&states(levels), 0.01).into_iter().map(|level| level_name(level, 0.01)).collect()
        };
        assert_eq!(names(&tumble), ["−1 g", "0 g", "+1 g"]);
        assert_eq!(names(&[0.0, 1.0, 1e-4, -1.0]), ["−1 g", "0 g", "+1 g"]);
        assert_eq!(
            (names(&[-0.866, 0.866]), names(&[0.5])),
            (vec!["−0.866 g".into(), "+0.866 g".into()], vec!["+0.5 g".into()])
        );
    }
}
