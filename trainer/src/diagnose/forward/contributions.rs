//! What effects do in each cell.

use super::effect_set::{EffectSet, is_placed};
use crate::campaign::Row;
use crate::diagnose::cells::{Cell, Cells, RunCells};
use crate::fit::effects::{self, Contribution, mean_contribution};
use rayon::prelude::*;

/// Mean contributions of the cells, run by run.
pub type Contributions = Vec<Vec<Contribution>>;

/// What the effects do in each cell.
pub fn contributions(cells: &Cells, set: &EffectSet) -> Contributions {
    let (placed, others) = set.split(is_placed);
    let of = |run: &RunCells| {
        let course = |rows: &[Row], set: &EffectSet| {
            let some = !set.effects.is_empty();
            some.then(|| effects::contributions(rows, &set.effects, &set.coefficients, cells.max_gap_us)).flatten()
        };
        let mut all = match course(&run.run.rows, &others) {
            Some(course) => run.cells.iter().map(|cell| mean_contribution(&course[cell.rows.clone()])).collect(),
            None => vec![Contribution::default(); run.cells.len()],
        };
        if let Some(course) = course(&run.groups.rows, &placed) {
            for (&(cell, share), contribution) in run.groups.places.iter().zip(course) {
                all[cell] = all[cell].plus(&contribution.times(share));
            }
        }
        all
    };
    cells.runs.par_iter().map(of).collect()
}

/// The inputs of a cell under a contribution.
pub fn moved(cells: &Cells, cell: &Cell, contribution: &Contribution) -> [f64; 2] {
    [
        cell.x - contribution.delta_f_hz / cells.scale.delta_f_half_span_hz,
        cell.t + contribution.temperature_c / cells.scale.temperature_half_span_c,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, effect, problem};

    #[test]
    fn on_a_steady_ramp_a_lag_is_its_time_constant_behind_and_a_gradient_in_proportion_to_the_rate() {
        let campaign = Recipe { runs: 2, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let set = EffectSet::NONE
            .with(&effect("thermal-lag", &campaign), &[90.0])
            .with(&effect("thermal-gradient", &campaign), &[6e-3, 30.0]);
        let all = contributions(problem.cells(), &set);
        // The first ramp, its beginning aside: 2 °C/min, up in the first run and down in the second.
        for (run, rate) in [(0, 2.0 / 60.0), (1, -2.0 / 60.0)] {
            let settled = |time_s: f64| (1500.0..2400.0).contains(&time_s);
            let pairs = problem.cells().runs[run].cells.iter().zip(&all[run]).filter(|(cell, _)| settled(cell.time_s));
            let mut count = 0;
            for (_, done) in pairs {
                count += 1;
                // A device's lag of exact steps is half a step ahead or behind.
                assert!((done.temperature_c / (-90.0 * rate) - 1.0).abs() < 0.12, "{}", done.temperature_c);
                assert!((done.bias_g / (6e-3 * rate) - 1.0).abs() < 0.35, "{}", done.bias_g);
                assert_eq!(done.delta_f_hz, 0.0);
            }
            assert!(count > 30, "{count}");
        }
        // At rest, before it, neither does anything.
        assert!(all[0][0].temperature_c.abs() < 1e-9 && all[0][0].bias_g.abs() < 1e-12);
    }

    #[test]
    fn what_sits_at_a_place_is_its_formula_at_each_samples_temperature_and_level() {
        let campaign = Recipe { runs: 2, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let [amplitude_g, width_c, crossing_c, shift] = [2e-4, 3.0, 20.0, 12.0];
        let crossing = effect("mode-crossing", &campaign);
        let alone = EffectSet::NONE.with(&crossing, &[amplitude_g, width_c, crossing_c, shift]);
        let warm_up = EffectSet::NONE.with(&effect("warm-up", &campaign), &[1e-4, 600.0]);
        let [all, other, both] =
            [&alone, &warm_up, &alone.and(&warm_up)].map(|set| contributions(problem.cells(), set));
        let mut largest = 0.0_f64;
        for (index, run) in problem.cells().runs.iter().enumerate() {
            for (cell, (cell_of, done)) in run.cells.iter().zip(&all[index]).enumerate() {
                let formula = |row: &Row| {
                    let away =
                        (f64::from(row.sample.temperature_uc) * 1e-6 - crossing_c - shift * row.reference_g) / width_c;
                    amplitude_g * 2.0 * away / (1.0 + away * away)
                };
                let rows = &run.run.rows[cell_of.rows.clone()];
                let worked = rows.iter().map(formula).sum::<f64>() / rows.len() as f64;
                assert!((done.bias_g - worked).abs() < 2e-3 * amplitude_g, "{} {worked}", done.bias_g);
                let sum = done.bias_g + other[index][cell].bias_g;
                assert!((both[index][cell].bias_g - sum).abs() < 1e-15);
                largest = largest.max(worked.abs());
            }
        }
        assert!(largest > 0.9 * amplitude_g, "{largest}");
    }
}
