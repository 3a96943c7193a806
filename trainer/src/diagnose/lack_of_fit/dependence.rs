//! What the residual depends on: a smooth function of one quantity after the other, judged like any effect.

use crate::diagnose::answer::Dependence;
use crate::diagnose::cells::{Cell, Columns, RunCells};
use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{NoiseModels, Problem, constrained};
use crate::diagnose::regression::Gls;
use crate::diagnose::thresholds::DEPENDENCE_DEGREE;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// A quantity's value in each cell, run by run.
struct Quantity {
    name: String,
    values: Vec<Vec<f64>>,
}

/// What every static calibration follows.
pub const TEMPERATURE: &str = "temperature_c";

/// How the residual follows each quantity, without and with the findings.
pub fn dependences(
    before: (&Problem, &EffectSet),
    after: (&Problem, &EffectSet),
    noises: &NoiseModels,
    channels: &[String],
) -> Vec<Dependence> {
    let gls = |(problem, set): (&Problem, &EffectSet)| {
        let nuisance = constrained(problem, set, noises).delta;
        let residual = problem.forward.residuals(set).delta;
        Some((Gls::new(problem.cells(), &noises.initial, &noises.delta, &residual, &nuisance)?, nuisance))
    };
    let problem = after.0;
    let (Some(before), Some(after)) = (gls(before), gls(after)) else { return Vec::new() };
    let judged = |(on, columns): (String, Columns)| {
        let [(before_ug, chance_before), (after_ug, chance_after)] =
            [&before, &after].map(|(gls, nuisance)| follows(gls, nuisance, &columns));
        Dependence { on, before_ug, after_ug, chance_before, chance_after }
    };
    let mut all: Vec<Dependence> = followed(problem, channels).into_par_iter().map(judged).collect();
    all.sort_by(|a, b| b.before_ug.total_cmp(&a.before_ug));
    all
}

/// Every quantity that varies, and smooth functions of it: of each run cells × their degree, without a unit.
pub fn followed(problem: &Problem, channels: &[String]) -> Vec<(String, Columns)> {
    let of = |quantity: Quantity| Some((quantity.name, smooth(&quantity.values)?));
    quantities(problem, channels).into_iter().filter_map(of).collect()
}

fn quantities(problem: &Problem, channels: &[String]) -> Vec<Quantity> {
    let of = |name: &str, value: &dyn Fn(&RunCells, &Cell) -> f64| {
        let values = |run: &RunCells| run.cells.iter().map(|cell| value(run, cell)).collect();
        Quantity { name: name.to_owned(), values: problem.cells().runs.iter().map(values).collect() }
    };
    let first = |run: &RunCells, cell: &Cell| run.run.rows[cell.rows.start].sample;
    let mut found = vec![
        of(TEMPERATURE, &|_, cell| cell.t),
        of("temperature_rate", &rate),
        of("reference_g", &|_, cell| cell.level_g),
        of("time_s", &|_, cell| cell.time_s),
        of("power_on_s", &|run, cell| first(run, cell).power_on_us as f64),
        of("age_days", &|run, cell| first(run, cell).age_s.map_or(0.0, f64::from)),
    ];
    for (index, name) in channels.iter().enumerate() {
        found.push(of(name, &|run, cell| first(run, cell).channels[index] as f64));
    }
    found
}

fn rate(run: &RunCells, cell: &Cell) -> f64 {
    let rows = &run.run.rows;
    let (first, last) =
        (rows[cell.rows.start.saturating_sub(1)].sample, rows[cell.rows.end.min(rows.len() - 1)].sample);
    let seconds = last.time_us.saturating_sub(first.time_us) as f64 * 1e-6;
    let warmer_c = (f64::from(last.temperature_uc) - f64::from(first.temperature_uc)) * 1e-6;
    if seconds > 0.0 { warmer_c / seconds } else { 0.0 }
}

/// Polynomials of the rank that each value has among all; `None` where there is but one value.
fn smooth(values: &[Vec<f64>]) -> Option<Columns> {
    let mut sorted: Vec<f64> = values.iter().flatten().copied().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let distinct = sorted.chunk_by(|a, b| a == b).count();
    let degree = DEPENDENCE_DEGREE.min(distinct.checked_sub(1)?);
    if degree == 0 {
        return None;
    }
    let rank = |value: f64| {
        let (below, within) = (sorted.partition_point(|v| *v < value), sorted.partition_point(|v| *v <= value));
        (below + within) as f64 / sorted.len() as f64 - 1.0
    };
    let columns = |values: &Vec<f64>| {
        let rows = values
            .iter()
            .flat_map(|value| (1..=degree as i32).map(|power| rank(*value).powi(power)).collect::<Vec<_>>());
        DMatrix::from_row_iterator(values.len(), degree, rows)
    };
    Some(values.iter().map(columns).collect())
}

/// RMS of the part that follows the columns and that the instrument can't absorb, noise deducted, and the probability of
/// as much by chance.
fn follows(gls: &Gls, nuisance: &Columns, columns: &Columns) -> (f64, f64) {
    let score = gls.score(columns);
    let (Some(amplitudes), Some(covariance)) = (score.amplitudes(), score.covariance()) else { return (0.0, 1.0) };
    let (mut squares, mut noise, mut cells) = (0.0, 0.0, 0.0);
    for run in gls.beyond(columns, nuisance) {
        squares += (&run * &amplitudes).norm_squared();
        noise += (&run * &covariance).component_mul(&run).sum();
        cells += run.nrows() as f64;
    }
    let size = ((squares - noise).max(0.0) / cells).sqrt();
    (size, chance(score.gain(), amplitudes.len() as f64))
}

/// Probability that a χ² variable exceeds `value` (Wilson & Hilferty 1931).
fn chance(value: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    let normal = ((value.max(0.0) / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    upper_tail(normal)
}

/// Probability that a normal variable exceeds `z`, to 1e-7 (Abramowitz & Stegun 26.2.17).
fn upper_tail(z: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * z.abs());
    let series =
        t * (0.319_381_530 + t * (-0.356_563_782 + t * (1.781_477_937 + t * (-1.821_255_978 + t * 1.330_274_429))));
    let tail = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt() * series;
    if z >= 0.0 { tail } else { 1.0 - tail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Moment, Recipe, problem, white};

    #[test]
    fn chances_are_those_of_the_tables() {
        for (value, freedom, table) in
            [(3.841, 1.0, 0.05), (18.307, 10.0, 0.05), (6.635, 1.0, 0.01), (23.209, 10.0, 0.01)]
        {
            let found = chance(value, freedom);
            assert!((found / table - 1.0).abs() < 0.06, "{value} at {freedom}: {found}");
        }
        assert!((upper_tail(0.0) - 0.5).abs() < 1e-6 && (upper_tail(-1.959_964) - 0.975).abs() < 1e-6);
    }

    fn found(bias_g: &dyn Fn(&Moment) -> f64) -> Vec<Dependence> {
        let course = |moment: &Moment| slow(moment);
        let campaign = Recipe { channel: Some(("stranger", &course)), bias_g, ..Recipe::default() }.campaign();
        let (problem, none) = (problem(&campaign), EffectSet::NONE);
        dependences((&problem, &none), (&problem, &none), &white(&problem, &none, 5.0), &campaign.channels)
    }

    /// From −1 to 1, of a period that nothing else has.
    fn slow(moment: &Moment) -> f64 {
        ((moment.time_s + 1700.0 * moment.run as f64) / 90.0).sin()
    }

    #[test]
    fn the_quantity_that_the_residual_follows_comes_first_with_its_size() {
        let all = found(&|moment| 40e-6 * slow(moment));
        let first = &all[0];
        assert_eq!(first.on, "stranger");
        assert!(
            (12.0..32.0).contains(&first.before_ug) && first.chance_before < 1e-12,
            "{} {}",
            first.before_ug,
            first.chance_before
        );
        assert!(all[1..].iter().all(|other| other.before_ug < 0.6 * first.before_ug), "{}", all[1].on);
        assert!((first.before_ug - first.after_ug).abs() < 1e-12);
        // Ages are not known, and power came with the clock.
        assert!(all.iter().all(|one| one.on != "age_days") && all.iter().any(|one| one.on == "power_on_s"));
    }

    #[test]
    fn noise_follows_nothing() {
        for one in found(&|_| 0.0) {
            assert!(
                one.before_ug < 2.0 && one.chance_before > 1e-4,
                "{}: {} {}",
                one.on,
                one.before_ug,
                one.chance_before
            );
        }
    }

    #[test]
    fn what_has_few_values_has_few_powers_and_what_has_one_has_none() {
        assert!(smooth(&[vec![3.0; 4], vec![3.0; 2]]).is_none());
        let two = smooth(&[vec![3.0, 3.0, 7.0], vec![7.0]]).unwrap();
        // The middle of each value's ranks, from −1 to 1.
        assert_eq!(two[0].as_slice(), [-0.5, -0.5, 0.5]);
        assert_eq!(two[1].as_slice(), [0.5]);
        let many = smooth(&[(0..50).map(f64::from).collect()]).unwrap();
        assert_eq!(many[0].ncols(), DEPENDENCE_DEGREE);
        assert!((many[0][(0, 1)] - 0.98_f64.powi(2)).abs() < 1e-12);
    }
}
