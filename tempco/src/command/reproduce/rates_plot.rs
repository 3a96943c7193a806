//! The success rates as a picture: what the domain, which the paper does not state, decides.

use crate::failure::Failure;
use crate::plot::{Area, BLUE, Entry, GREEN, GREY, ORANGE, SKY, VERMILION, axis, heading, label, mesh, picture};
use plotters::prelude::*;
use trainer::reproduction::contender::Contender;
use trainer::reproduction::trial::Trial;

type DrawError = DrawingAreaErrorKind<std::io::Error>;

const SIZE: (u32, u32) = (1200, 600);

/// One panel a function, one line a search, 95 % intervals as bars.
pub fn rates(trials: &[Trial]) -> Result<String, Failure> {
    let seeds = trials.first().map_or(0, |trial| trial.ends.len());
    let title = format!("How many of {seeds} seeds find the global minimum depends on the domain");
    let legend = Contender::ALL.map(|contender| Entry::line(contender.name(), colour(contender)));
    picture(SIZE, &title, &legend, |area| {
        for (panel, function) in area.split_evenly((1, 2)).iter().zip(["Schaffer", "Rastrigin"]) {
            let here: Vec<&Trial> = trials.iter().filter(|trial| trial.field.function.name == function).collect();
            draw(panel, function, &here)?;
        }
        Ok::<(), DrawError>(())
    })
}

const fn colour(contender: Contender) -> RGBColor {
    match contender {
        Contender::RandomPoints => GREY,
        Contender::FaPrinted => ORANGE,
        Contender::FaRecommended => VERMILION,
        Contender::IfaPrinted => SKY,
        Contender::IfaSchedule => GREEN,
        Contender::IfaRecommended => BLUE,
    }
}

/// So far apart stand the bars of one domain, in units of the distance of domains.
const APART: f64 = 0.05;

/// Where the bars of a domain stand that belong to a search.
fn across(position: usize, search: usize) -> f64 {
    position as f64 + (search as f64 - (Contender::ALL.len() - 1) as f64 / 2.0) * APART
}

fn draw(area: &Area, function: &str, trials: &[&Trial]) -> Result<(), DrawError> {
    let of = |contender| trials.iter().filter(move |trial| trial.contender == contender);
    let widths: Vec<f64> = of(Contender::RandomPoints).map(|trial| trial.field.half_width).collect();
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .caption(format!("{function}'s function"), heading())
        .x_label_area_size(46)
        .y_label_area_size(64)
        .build_cartesian_2d(-0.4..widths.len() as f64 - 0.6, -2.0..102.0)?;
    let name = |x: &f64| {
        let nearest = x.round();
        let named = (x - nearest).abs() < 1e-6 && nearest >= 0.0;
        named.then(|| widths.get(nearest as usize).map(|width| format!("±{width}"))).flatten().unwrap_or_default()
    };
    let percent = |value: &f64| format!("{value:.0} %");
    let mut grid = chart.configure_mesh();
    grid.disable_x_mesh().x_labels(4).y_labels(6).light_line_style(WHITE).bold_line_style(mesh());
    grid.axis_style(axis()).label_style(label()).axis_desc_style(label());
    grid.x_label_formatter(&name)
        .y_label_formatter(&percent)
        .x_desc("domain of each coordinate")
        .y_desc("seeds that find it");
    grid.draw()?;
    for (index, contender) in Contender::ALL.into_iter().enumerate() {
        let (line, dot) = (colour(contender).stroke_width(2), colour(contender).filled());
        let points: Vec<(f64, &Trial)> =
            of(contender).enumerate().map(|(position, trial)| (across(position, index), *trial)).collect();
        chart.draw_series(LineSeries::new(points.iter().map(|(x, trial)| (*x, trial.found().percent())), line))?;
        chart.draw_series(points.iter().map(|(x, trial)| {
            PathElement::new(trial.found().interval_percent().map(|end| (*x, end)).to_vec(), line)
        }))?;
        chart.draw_series(points.iter().map(|(x, trial)| Circle::new((*x, trial.found().percent()), 4, dot)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::reproduction::contender::FIELDS;
    use trainer::reproduction::trial::trial;

    #[test]
    fn the_bars_of_a_domain_stand_side_by_side_around_its_middle() {
        for domain in 0..4 {
            let bars: Vec<f64> = (0..Contender::ALL.len()).map(|search| across(domain, search)).collect();
            assert!(bars.windows(2).all(|pair| (pair[1] - pair[0] - APART).abs() < 1e-12), "{bars:?}");
            let middle = bars.iter().sum::<f64>() / bars.len() as f64;
            assert!((middle - domain as f64).abs() < 1e-12, "{bars:?}");
        }
    }

    #[test]
    fn every_domain_is_named_below_its_bars_once() {
        let points = |field| trial(Contender::RandomPoints, field, 3, 1).expect("a field with extent");
        let svg = rates(&FIELDS.map(points)).expect("a picture");
        let texts: Vec<&str> = svg.lines().map(str::trim).collect();
        let shown = |text: &str| texts.iter().filter(|one| **one == text).count();
        for (text, times) in [("±1", 2), ("±2", 2), ("±5", 1), ("±5.12", 1), ("±10", 2), ("100 %", 2)] {
            assert_eq!(shown(text), times, "{text}");
        }
    }
}
