//! Figures 3 and 4: how best and mean fall with the generations.

use super::claims::percent;
use crate::failure::Failure;
use crate::plot::{Area, BLUE, Entry, VERMILION, axis, heading, label, mesh, picture};
use plotters::prelude::*;
use trainer::fit::firefly::Generation;
use trainer::reproduction::contender::{Contender, Field};
use trainer::reproduction::evolution::{Evolution, Quartiles};
use trainer::reproduction::trial::Trial;

type DrawError = DrawingAreaErrorKind<std::io::Error>;

const SIZE: (u32, u32) = (1400, 760);
const BEST: RGBColor = BLUE;
const MEAN: RGBColor = VERMILION;

/// FA above, IFA below, as printed; one column a domain, with a common scale.
pub fn evolution(function: &str, trials: &[Trial]) -> Result<String, Failure> {
    let row = |contender: Contender| -> Vec<&Trial> {
        let here = |trial: &&Trial| trial.contender == contender && trial.field.function.name == function;
        trials.iter().filter(here).collect()
    };
    let rows = [row(Contender::FaPrinted), row(Contender::IfaPrinted)];
    let seeds = rows[0].first().map_or(0, |trial| trial.ends.len());
    let title =
        format!("{function}'s function, {seeds} seeds: evolution of the FA (above) and the IFA (below) as printed");
    let legend = [
        Entry::line("best firefly, median seed", BEST),
        Entry::band("middle half of all seeds", BEST),
        Entry::line("mean of the swarm, median seed", MEAN),
        Entry::band("middle half of all seeds", MEAN),
    ];
    picture(SIZE, &title, &legend, |area| {
        let panels = area.split_evenly((2, rows[0].len().max(1)));
        for (column, pair) in rows[0].iter().zip(&rows[1]).enumerate() {
            let range = range(&[pair.0, pair.1]);
            for (row, trial) in [pair.0, pair.1].into_iter().enumerate() {
                panel(&panels[row * rows[0].len() + column], trial, range, column == 0, row == 1)?;
            }
        }
        Ok::<(), DrawError>(())
    })
}

/// From a little below the global minimum to where the bands begin.
fn range(trials: &[&Trial]) -> (f64, f64) {
    let minimum = trials.first().map_or(0.0, |trial| trial.field.function.minimum);
    let tops =
        trials.iter().filter_map(|trial| trial.evolution.as_ref()?.mean.iter().map(|q| q.upper).reduce(f64::max));
    let top = tops.fold(minimum + f64::EPSILON, f64::max);
    (minimum - 0.04 * (top - minimum), top + 0.04 * (top - minimum))
}

fn panel(area: &Area, trial: &Trial, (low, high): (f64, f64), leftmost: bool, lowest: bool) -> Result<(), DrawError> {
    let Some(evolution) = &trial.evolution else { return Ok(()) };
    let last = evolution.best.len().saturating_sub(1);
    let mut chart = ChartBuilder::on(area)
        .margin_left(8)
        .margin_right(14)
        .margin_top(6)
        .caption(caption(trial), heading())
        .x_label_area_size(if lowest { 42 } else { 24 })
        .y_label_area_size(if leftmost { 62 } else { 46 })
        .build_cartesian_2d(0..last, low..high)?;
    let mut grid = chart.configure_mesh();
    grid.disable_x_mesh().x_labels(6).y_labels(6).light_line_style(WHITE).bold_line_style(mesh());
    grid.axis_style(axis()).label_style(label()).axis_desc_style(label());
    let decimals = if high - low < 2.0 { 1 } else { 0 };
    let number = move |value: &f64| format!("{value:.decimals$}").replace('-', "−");
    grid.y_label_formatter(&number);
    if leftmost {
        grid.y_desc("cost");
    }
    if lowest {
        grid.x_desc("generation");
    }
    grid.draw()?;
    let Evolution { best, mean, typical, .. } = evolution;
    for (quartiles, colour) in [(mean, MEAN), (best, BEST)] {
        chart.draw_series([Polygon::new(band(quartiles, high), colour.mix(0.22))])?;
    }
    for (value, colour) in [(mean_of as fn(&Generation) -> f64, MEAN), (best_of, BEST)] {
        // A single seed may leave the picture; the bands do not.
        let line = typical.iter().enumerate().map(|(n, generation)| (n, value(generation).min(high)));
        chart.draw_series(LineSeries::new(line, colour.stroke_width(2)))?;
    }
    Ok(())
}

fn caption(trial: &Trial) -> String {
    let Field { function, half_width } = trial.field;
    let name = if trial.contender == Contender::FaPrinted { "FA" } else { "IFA" };
    let minimum = format!("{}", function.minimum).replace('-', "−");
    format!("{name}, |x| ≤ {half_width}: {} % of seeds find {minimum}", percent(trial.found()))
}

fn best_of(generation: &Generation) -> f64 {
    generation.best
}

fn mean_of(generation: &Generation) -> f64 {
    generation.mean
}

/// The outline of a quartile band: there along the lower edge, back along the upper.
fn band(quartiles: &[Quartiles], high: f64) -> Vec<(usize, f64)> {
    let lower = quartiles.iter().enumerate().map(|(n, q)| (n, q.lower.min(high)));
    let upper = quartiles.iter().enumerate().map(|(n, q)| (n, q.upper.min(high)));
    lower.chain(upper.rev()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::reproduction::contender::FIELDS;

    fn trial(uppers: &[f64]) -> Trial {
        let history: Vec<Generation> = uppers.iter().map(|&mean| Generation { best: 0.0, mean }).collect();
        let evolution = Evolution::of(&[history]);
        Trial { contender: Contender::FaPrinted, field: FIELDS[4], evaluations: 0.0, ends: Vec::new(), evolution }
    }

    #[test]
    fn the_scale_is_common_and_leaves_a_margin_below_the_minimum_and_above_the_highest_band() {
        let (one, other) = (trial(&[3.0, 8.0, 2.0]), trial(&[10.0, 5.0]));
        let minimum = FIELDS[4].function.minimum;
        let (low, high) = range(&[&one, &other]);
        let margin = 0.04 * (10.0 - minimum);
        assert!((low - (minimum - margin)).abs() < 1e-12 && (high - (10.0 + margin)).abs() < 1e-12, "{low} {high}");
    }

    #[test]
    fn a_panel_a_domain_is_drawn_for_each_of_the_two_and_axes_are_named_at_the_edges_only() {
        let of = |contender| FIELDS.map(|field| trainer::reproduction::trial::trial(contender, field, 5, 1));
        let trials: Vec<Trial> =
            Contender::ALL.into_iter().flat_map(of).collect::<Result<_, _>>().expect("fields with extent");
        let svg = evolution("Rastrigin", &trials).expect("a picture");
        let texts: Vec<&str> = svg.lines().map(str::trim).collect();
        let shown = |text: &str| texts.iter().filter(|one| one.contains(text)).count();
        for half_width in ["1", "2", "5.12", "10"] {
            assert_eq!(shown(&format!("FA, |x| ≤ {half_width}: ")), 2, "IFA and FA, ±{half_width}");
            assert_eq!(shown(&format!("IFA, |x| ≤ {half_width}: ")), 1, "±{half_width}");
        }
        assert_eq!((shown("% of seeds find 0"), shown("% of seeds find −1")), (8, 0));
        let exactly = |text: &str| texts.iter().filter(|one| **one == text).count();
        assert_eq!((exactly("cost"), exactly("generation")), (2, 4));
        assert_eq!(svg.matches("<polygon ").count(), 16, "two bands a panel");
        assert_eq!(shown("s function, 5 seeds: evolution of"), 1);
    }

    #[test]
    fn each_line_is_drawn_of_its_own_cost() {
        let generation = Generation { best: 1.5, mean: 2.5 };
        assert_eq!((best_of(&generation), mean_of(&generation)), (1.5, 2.5));
    }

    #[test]
    fn a_band_goes_there_along_its_lower_edge_and_back_along_its_upper_and_stays_in_the_picture() {
        let of = |lower: f64, upper: f64| Quartiles { lower, median: lower, upper };
        let outline = band(&[of(1.0, 9.0), of(2.0, 3.0)], 5.0);
        assert_eq!(outline, [(0, 1.0), (1, 2.0), (1, 3.0), (0, 5.0)]);
    }
}
